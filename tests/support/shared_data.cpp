// SPDX-License-Identifier: Apache-2.0
#include "shared_data.hpp"

#include <cstdlib>

#include "source_folder.hpp"

namespace quadtune::testing {

std::filesystem::path shared_data() {
  const char* named = std::getenv("QUADTUNE_DATA");
  const std::filesystem::path folder =
      named ? std::filesystem::path(named)
            : std::filesystem::path(testing::source_folder()).parent_path() / "shared" / "data";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

}  // namespace quadtune::testing
