// SPDX-License-Identifier: Apache-2.0
/// Results as rows: JSON objects of the same members, which a text shows as a table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

/// The texts of a table, row by row.
using Cells = std::vector<std::vector<std::string>>;

/// Cells in columns that are as wide as their widest cell, two blanks apart. Blanks at the end of a
/// line are left out.
/// @param cells  rows of equal length, headings included
/// @param sides  '<' or '>' for each column: where its cells stand; the last one counts for all
///               further columns
/// @return       one row a line, without a line feed at the end
[[nodiscard]] std::string aligned(const Cells& cells, std::string_view sides = "<>");

/// A column of a table: which member of the rows it shows, and how.
struct Column {
  std::string key;  ///< of the member; "a/b" is the member "b" of the member "a"
  std::string heading = "";
  std::string unit = "";    ///< below the heading
  std::string format = "";  ///< of numbers, for figure(); empty: as in JSON
  double factor = 1;        ///< by which numbers are multiplied: 1e3 shows seconds in "[ms]"
  const char* zero = "0";   ///< for the number 0, where that stands for something missing
  const char* yes = "";     ///< for true
  const char* no = "";      ///< for false
};

/// The rows below the headings. Texts stand to the left and numbers to the right.
/// @param rows  an array of objects; a member that is missing, null or not finite is "-"
[[nodiscard]] std::string table(const internal::Json& rows, const std::vector<Column>& columns);

/// "12.3"; "-" if the value is not finite. From 1000 on fixed formats show no more than one digit
/// behind the point, and from 1e6 on one digit and the exponent.
/// @param format  as fmt has it
[[nodiscard]] std::string figure(double value, std::string_view format);
/// The same of something that a flight may never reach: "never" if it is infinite.
[[nodiscard]] std::string reached(double value, std::string_view format);

}  // namespace quadtune::report
