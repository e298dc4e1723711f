// SPDX-License-Identifier: Apache-2.0
#include "report/text/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

/// The member that a column shows; null if it is missing.
const Json& member_of(const Json& row, const std::string& key) {
  static const Json kMissing = nullptr;
  const std::size_t slash = key.find('/');
  const Json* found = row.find(key.substr(0, slash));
  if (found == nullptr) return kMissing;
  return slash == std::string::npos ? *found : member_of(*found, key.substr(slash + 1));
}

std::string cell(const Json& value, const Column& column) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.text();
  if (value.is_boolean()) return value.get<bool>() ? column.yes : column.no;
  if (!value.is_number() || column.format.empty()) return internal::json_text(value);
  const double number = value.get<double>();
  return number == 0 && *column.zero != '0' ? column.zero
                                            : figure(number * column.factor, column.format);
}

}  // namespace

std::string aligned(const Cells& cells, std::string_view sides) {
  std::vector<std::size_t> widths;
  for (const auto& row : cells) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::vector<std::string> lines;
  for (const auto& row : cells) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].size(), ' ');
      const bool left = sides[std::min(i, sides.size() - 1)] == '<';
      line += (i > 0 ? "  " : "") + (left ? row[i] + padding : padding + row[i]);
    }
    lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
  }
  return internal::joined(lines, "\n");
}

std::string table(const Json& rows, const std::vector<Column>& columns) {
  const bool has_units = std::any_of(columns.begin(), columns.end(),
                                     [](const Column& column) { return !column.unit.empty(); });
  Cells cells(has_units ? 2 : 1);
  std::string sides;
  for (const Column& column : columns) {
    if (has_units) cells[0].push_back(column.unit.empty() ? "" : column.heading);
    cells.back().push_back(column.unit.empty() ? column.heading : column.unit);
    const bool is_text = std::any_of(rows.begin(), rows.end(), [&](const Json& row) {
      const Json& value = member_of(row, column.key);
      return value.is_string() || value.is_boolean();
    });
    sides += is_text ? '<' : '>';
  }
  for (const Json& row : rows) {
    cells.emplace_back();
    for (const Column& column : columns)
      cells.back().push_back(cell(member_of(row, column.key), column));
  }
  return aligned(cells, sides);
}

std::string figure(double value, std::string_view format) {
  if (!std::isfinite(value)) return "-";
  if (format.back() == 'f' && std::abs(value) >= 1e6) format = ".0e";
  if (format.back() == 'f' && std::abs(value) >= 1000 && format != ".1f") format = ".0f";
  return fmt::format(fmt::runtime(fmt::format("{{:{}}}", format)), value);
}

std::string reached(double value, std::string_view format) {
  return std::isinf(value) ? "never" : figure(value, format);
}

}  // namespace quadtune::report
