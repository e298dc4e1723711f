// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/exports_below.hpp"

#include <algorithm>

#include "quadtune/exports/manifest.hpp"

namespace quadtune {

namespace fs = std::filesystem;

std::vector<std::string> exports_below(const fs::path& directory) {
  std::vector<std::string> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error))
    if (fs::exists(entry.path() / kManifestName, error)) found.push_back(entry.path().string());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace quadtune
