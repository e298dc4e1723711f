// SPDX-License-Identifier: Apache-2.0
/// Tables of text: the one place that pads cells.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace quadtune::report {

/// A column: its heading, its width [characters], and on which side its cells stand.
struct TextColumn {
  enum class Side { left, right };

  std::string heading;
  std::size_t width = 0;  ///< of the column; a longer cell is wider
  Side side = Side::right;
};

/// Columns of fixed width, one row a line. Blanks at the end of a line are left out.
class TextTable {
 public:
  explicit TextTable(std::vector<TextColumn> columns) : columns_(std::move(columns)) {}

  /// @param cells  one for each column, or fewer: those that are missing are empty
  void row(const std::vector<std::string>& cells);

  /// @return  the rows, one a line, without a line feed at the end
  [[nodiscard]] const std::string& rows() const { return rows_; }
  /// The headings, and below them the rows.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] std::string line(const std::vector<std::string>& cells) const;

  std::vector<TextColumn> columns_;
  std::string rows_;
};

}  // namespace quadtune::report
