// SPDX-License-Identifier: Apache-2.0
/// The files of the report's page, embedded at build time.
#pragma once

#include <string_view>
#include <vector>

namespace quadtune::report {

struct Asset {
  std::string_view name;  ///< below page/assets, e.g. "vendor/uplot.min.js"
  std::string_view text;
};

/// All of them; they live as long as the program.
[[nodiscard]] const std::vector<Asset>& assets();

}  // namespace quadtune::report
