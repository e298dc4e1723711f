// SPDX-License-Identifier: Apache-2.0
/// The files of vehicles/, missions/ and filters/, compiled into the library by
/// lib/embed_files.cmake, and how a word is told from a path.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace quadtune::internal {

/// A file that the library carries.
struct BuiltInFile {
  std::string name;  ///< "mambo"
  std::string path;  ///< "vehicles/mambo.toml", as messages call it
  std::string text;  ///< its bytes
};

/// All of them, in the order of the documentation.
[[nodiscard]] const std::vector<BuiltInFile>& built_in_vehicle_files();
[[nodiscard]] const std::vector<BuiltInFile>& built_in_mission_files();
[[nodiscard]] const std::vector<BuiltInFile>& built_in_filter_files();

/// Whether a word that names nothing built in is meant as a file's path.
[[nodiscard]] inline bool looks_like_path(const std::string& word) {
  std::error_code ignored;  // a word too long for a file name is none
  return word.find('/') != std::string::npos || word.ends_with(".toml") ||
         std::filesystem::exists(word, ignored);
}

}  // namespace quadtune::internal
