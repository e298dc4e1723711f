// SPDX-License-Identifier: Apache-2.0
/// Compares an export with the result of its design file.
#pragma once

#include <filesystem>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {

/// Creates the export of a solved design again and compares every file, comments included, and the
/// laws, weights and numbers of the manifest. Numbers may differ by up to 1e-7 of the largest of
/// their line, as between machines; values derived from such numbers are left to the other checks.
/// The options of the export (precision, firmware, adapter) are read from its files.
///
/// @param directory  of the export
/// @param manifest   of the export
/// @param outcome    of the design file that the manifest names
[[nodiscard]] VerifyCheck check_design(const std::filesystem::path& directory,
                                       const Manifest& manifest, const DesignOutcome& outcome);

}  // namespace quadtune
