// SPDX-License-Identifier: Apache-2.0
#include "golden.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "source_folder.hpp"

namespace quadtune::testing {

::testing::AssertionResult matches_document(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::source_folder()) / name;
  if (std::getenv("QUADTUNE_UPDATE_DOCS")) {
    std::ofstream(path) << text;
    return ::testing::AssertionSuccess() << name << " rewritten";
  }
  std::ifstream file(path);
  std::ostringstream stands;
  stands << file.rdbuf();
  if (stands.str() == text) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << name << " does not say what this build computes; run the test once with "
         << "QUADTUNE_UPDATE_DOCS=1 and read the difference. It would say:\n"
         << text;
}

}  // namespace quadtune::testing
