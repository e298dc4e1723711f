// SPDX-License-Identifier: Apache-2.0
/// An export compared with what its design file gives.
#pragma once

#include <filesystem>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {

/// Makes the export of a solved design again and compares every file, comments included, and what
/// the manifest says of laws, weights and numbers. Numbers that differ by up to 1e-7 of the largest
/// of their line, as those of another machine may, are accepted, and what is made from such numbers
/// is left to the other checks. The options of the export (precision, firmware, adapter) are taken
/// from its files.
///
/// @param outcome  of the design file that the manifest names
[[nodiscard]] VerifyCheck check_design(const std::filesystem::path& directory,
                                       const Manifest& manifest, const DesignOutcome& outcome);

}  // namespace quadtune
