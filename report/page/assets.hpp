// SPDX-License-Identifier: Apache-2.0
/// The files of the web pages, embedded at build time.
#pragma once

#include <string_view>
#include <vector>

namespace quadtune::report {

struct Asset {
  std::string_view name;  ///< path below page/assets, e.g. "vendor/uplot.min.js"
  std::string_view text;
};

/// All assets; they remain valid for the lifetime of the program.
[[nodiscard]] const std::vector<Asset>& assets();

}  // namespace quadtune::report
