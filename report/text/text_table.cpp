// SPDX-License-Identifier: Apache-2.0
#include "report/text/text_table.hpp"

#include <fmt/format.h>

namespace quadtune::report {

std::string TextTable::line(const std::vector<std::string>& cells) const {
  std::string text;
  for (std::size_t i = 0; i < cells.size() && i < columns_.size(); ++i)
    text += columns_[i].side == TextColumn::Side::left
                ? fmt::format("{:<{}}", cells[i], columns_[i].width)
                : fmt::format("{:>{}}", cells[i], columns_[i].width);
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

void TextTable::row(const std::vector<std::string>& cells) {
  rows_ += (rows_.empty() ? "" : "\n") + line(cells);
}

std::string TextTable::text() const {
  std::vector<std::string> headings;
  headings.reserve(columns_.size());
  for (const TextColumn& column : columns_) headings.push_back(column.heading);
  return rows_.empty() ? line(headings) : line(headings) + "\n" + rows_;
}

}  // namespace quadtune::report
