// SPDX-License-Identifier: Apache-2.0
/// Tables of text whose columns are as wide as their cells.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace quadtune::report {

/// Two blanks between columns. The first `words` columns and the last stand to the left, numbers to
/// the right.
/// @param rows  at least one, all of as many cells; the first holds the headings
/// @return      one row a line, without a line feed at the end
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& rows,
                                  std::size_t words = 1);

}  // namespace quadtune::report
