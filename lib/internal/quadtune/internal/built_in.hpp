// SPDX-License-Identifier: Apache-2.0
/// The files of vehicles/, missions/ and filters/, compiled into the library by
/// lib/embed_files.cmake, and the rule that distinguishes their names from paths.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace quadtune::internal {

/// A file that is compiled into the library.
struct BuiltInFile {
  std::string name;  ///< "mambo"
  std::string path;  ///< "vehicles/mambo.toml", its name in messages
  std::string text;  ///< its bytes
};

/// All built-in files, in the order of the documentation.
[[nodiscard]] const std::vector<BuiltInFile>& built_in_vehicle_files();
[[nodiscard]] const std::vector<BuiltInFile>& built_in_mission_files();
[[nodiscard]] const std::vector<BuiltInFile>& built_in_filter_files();

/// Whether a word that is not a built-in name is treated as a file path.
[[nodiscard]] inline bool looks_like_path(const std::string& word) {
  std::error_code ignored;  // a word that is too long for a file name is not a file
  return word.find('/') != std::string::npos || word.ends_with(".toml") ||
         std::filesystem::exists(word, ignored);
}

}  // namespace quadtune::internal
