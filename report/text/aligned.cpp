// SPDX-License-Identifier: Apache-2.0
#include "report/text/aligned.hpp"

#include <algorithm>

#include "report/text/text_table.hpp"

namespace quadtune::report {

std::string aligned(const std::vector<std::vector<std::string>>& rows, std::size_t words) {
  constexpr std::size_t kGap = 2;
  const std::size_t count = rows.front().size();
  const auto is_left = [&](std::size_t i) { return i < words || i + 1 == count; };
  std::vector<TextColumn> columns(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& row : rows) columns[i].width = std::max(columns[i].width, row[i].size());
    if (i > 0) columns[i].width += kGap;
    if (is_left(i)) columns[i].side = TextColumn::Side::left;
  }
  TextTable table(std::move(columns));
  for (std::vector<std::string> row : rows) {
    for (std::size_t i = 1; i < count; ++i)
      if (is_left(i)) row[i].insert(0, kGap, ' ');
    table.row(row);
  }
  return table.rows();
}

}  // namespace quadtune::report
