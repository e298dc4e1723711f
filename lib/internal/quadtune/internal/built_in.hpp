// SPDX-License-Identifier: Apache-2.0
/// The vehicle files of vehicles/, compiled into the library by lib/embed_vehicles.cmake.
#pragma once

#include <string>
#include <vector>

namespace quadtune::internal {

/// A file that the library carries.
struct BuiltInFile {
  std::string name;  ///< "mambo"
  std::string path;  ///< "vehicles/mambo.toml", as messages call it
  std::string text;  ///< its bytes
};

/// All of them, in the order of the documentation.
[[nodiscard]] const std::vector<BuiltInFile>& built_in_files();

}  // namespace quadtune::internal
