// SPDX-License-Identifier: Apache-2.0
/// Finds the exports in a folder, for messages about a folder that is not an export itself.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quadtune {

/// Subfolders that are exports, such as those of a design with several exports.
///
/// @return  their paths, `directory` first, sorted; empty if the directory cannot be read
[[nodiscard]] std::vector<std::string> exports_below(const std::filesystem::path& directory);

}  // namespace quadtune
