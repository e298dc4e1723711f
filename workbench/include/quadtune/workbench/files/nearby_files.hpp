// SPDX-License-Identifier: Apache-2.0
/// Where a file is missing: what is in its folder instead.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace quadtune {

/// The folder of a path, and the names in it that are nearest to that of the path.
struct NearbyFiles {
  std::filesystem::path folder;    ///< "." for a path without one
  bool exists = true;              ///< whether there is such a folder
  std::vector<std::string> names;  ///< the nearest first, by letters to be changed
  std::size_t more = 0;            ///< names that are left out
};

/// Looks at 10,000 entries of the folder at most, and at no hidden ones. Where some have the path's
/// extension, the others are not counted.
/// @param most  names that are given
[[nodiscard]] NearbyFiles nearby_files(const std::filesystem::path& path, std::size_t most);

}  // namespace quadtune
