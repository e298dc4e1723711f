// SPDX-License-Identifier: Apache-2.0
/// Whether an export can be compared byte by byte with the output of this version.
#pragma once

#include <algorithm>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/version.hpp"

namespace quadtune::exports {

[[nodiscard]] inline bool is_of_this_version(const Manifest& manifest) {
  return std::any_of(manifest.versions.begin(), manifest.versions.end(), [](const auto& version) {
    return version.first == "quadtune" && version.second == kVersion;
  });
}

}  // namespace quadtune::exports
