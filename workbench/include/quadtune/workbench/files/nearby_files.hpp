// SPDX-License-Identifier: Apache-2.0
/// Suggestions for a missing file: similar names in its folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace quadtune {

/// The folder of a path, and the names in it that are most similar to that of the path.
struct NearbyFiles {
  std::filesystem::path folder;    ///< "." if the path has no folder
  bool exists = true;              ///< whether the folder exists
  std::vector<std::string> names;  ///< most similar first, by edit distance
  std::size_t more = 0;            ///< number of omitted names
};

/// Inspects at most 10,000 entries of the folder and ignores hidden ones. If some entries have the
/// extension of the path, only those are considered; if the path has none, an entry that differs
/// only by its extension is the most similar.
/// @param max  maximum number of names
[[nodiscard]] NearbyFiles nearby_files(const std::filesystem::path& path, std::size_t max);

}  // namespace quadtune
