// SPDX-License-Identifier: Apache-2.0
/// Results as rows: JSON objects with the same members, which a text shows as a table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

/// The texts of a table, row by row.
using Cells = std::vector<std::vector<std::string>>;

/// Aligns cells in columns that are as wide as their widest cell, separated by two blanks. Trailing
/// blanks are omitted.
/// @param cells  rows of equal length, headings included
/// @param sides  '<' or '>' for each column: left or right alignment; the last one applies to all
///               further columns
/// @return       one line for each row, without a line feed at the end
[[nodiscard]] std::string aligned(const Cells& cells, std::string_view sides = "<>");

/// A column of a table: which member of the rows it shows, and in which format.
struct Column {
  std::string key;  ///< key of the member; "a/b" is the member "b" of the member "a"
  std::string heading = "";
  std::string unit = "";    ///< below the heading
  std::string format = "";  ///< format of numbers, for figure(); empty: as in JSON
  double factor = 1;        ///< factor of the numbers: 1e3 shows seconds in "[ms]"
  const char* zero = "0";   ///< text for the number 0, if that means a missing value
  const char* yes = "";     ///< text for true
  const char* no = "";      ///< text for false
};

/// The headings and the rows. Texts are aligned to the left and numbers to the right.
/// @param rows  an array of objects; a member that is missing, null or not finite is shown as "-"
[[nodiscard]] std::string table(const internal::Json& rows, const std::vector<Column>& columns);

/// "12.3"; "-" if the value is not finite. From 1000 on, fixed formats show at most one decimal,
/// and from 1e6 on one digit and the exponent.
/// @param format  in the syntax of fmt
[[nodiscard]] std::string figure(double value, std::string_view format);
/// The same for a quantity that a flight may never reach: "never" if it is infinite.
[[nodiscard]] std::string reached(double value, std::string_view format);

}  // namespace quadtune::report
