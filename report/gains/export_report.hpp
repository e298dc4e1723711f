// SPDX-License-Identifier: Apache-2.0
/// Files that were written for another program.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

/// [{"path": …, "sha256": …}, …]
[[nodiscard]] internal::Json to_json(const std::vector<ManifestFile>& files);
/// One line a file, as sha256sum prints it.
/// @param directory  in which they are
[[nodiscard]] std::string to_text(const std::vector<ManifestFile>& files,
                                  const std::string& directory);

}  // namespace quadtune::report
