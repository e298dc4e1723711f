// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "mutate.hpp"

namespace quadtune::mutations {
namespace {

/// Rows of cells with their separators.
struct Table {
  char separator = ' ';
  std::vector<std::vector<std::string>> rows;

  [[nodiscard]] std::string text() const {
    std::string result;
    for (const auto& row : rows) {
      for (std::size_t i = 0; i < row.size(); ++i)
        result += (i > 0 ? std::string(1, separator) : "") + row[i];
      result += "\n";
    }
    return result;
  }
};

Table table_of(const std::string& text) {
  Table table;
  for (const char candidate : {',', ';', '\t'})
    if (text.find(candidate) != std::string::npos) {
      table.separator = candidate;
      break;
    }
  std::vector<std::string> row(1);
  for (const char c : text) {
    if (c == '\n') {
      table.rows.push_back(row);
      row.assign(1, "");
    } else if (c == table.separator) {
      row.emplace_back();
    } else if (c != '\r') {
      row.back() += c;
    }
  }
  if (row.size() > 1 || !row[0].empty()) table.rows.push_back(row);
  return table;
}

bool is_number(const std::string& cell, double& value) {
  char* end = nullptr;
  value = std::strtod(cell.c_str(), &end);
  return end != cell.c_str() && end && *end == '\0';
}

/// Rows that are neither comment nor names.
std::vector<std::size_t> number_rows(const Table& table) {
  std::vector<std::size_t> rows;
  double value = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (std::any_of(table.rows[i].begin(), table.rows[i].end(),
                    [&](const std::string& cell) { return is_number(cell, value); }))
      rows.push_back(i);
  return rows;
}

/// Changes every number of a column, or of all columns if it is -1, by a function of its value and
/// its row.
template <class Function>
void each(Table& table, std::ptrdiff_t column, Function&& function) {
  std::size_t count = 0;
  for (const std::size_t i : number_rows(table)) {
    auto& row = table.rows[i];
    for (std::size_t j = 0; j < row.size(); ++j) {
      double value = 0;
      if (column >= 0 && std::ptrdiff_t(j) != column) continue;
      if (is_number(row[j], value)) row[j] = function(value, count, row[j]);
    }
    ++count;
  }
}

std::string number(double value) { return fmt::format("{}", value); }

/// A clock that stops, jumps, runs backwards or has another unit.
void change_clock(Table& table, std::ptrdiff_t column, Random& random) {
  const std::size_t odd = random.below(number_rows(table).size());
  const std::size_t how = random.below(8);
  each(table, column, [&](double value, std::size_t row, const std::string& cell) -> std::string {
    switch (how) {
      case 0:
        return number(-value);
      case 1:
        return row == odd ? number(0) : cell;
      case 2:
        return number(value * 1e9);
      case 3:
        return fmt::format("{:.0f}", 1.6e18 + value * 1e9);
      case 4:
        return number(1);
      case 5:
        return row >= odd ? number(value + 1e6) : cell;
      case 6:
        return row >= odd ? number(value - 0.3) : cell;
      default:
        return number(value + 1e15);
    }
  });
}

void change_column(Table& table, Random& random) {
  const std::vector<std::size_t> rows = number_rows(table);
  if (rows.empty()) return;
  const std::size_t columns = table.rows[rows[0]].size();
  const auto column = static_cast<std::ptrdiff_t>(random.below(columns));
  std::string odd = random.of(odd_numbers());
  switch (random.below(8)) {
    case 0:
      change_clock(table, 0, random);
      break;
    case 1:
      each(table, column, [&](double, std::size_t, const std::string&) { return odd; });
      break;
    case 2: {
      const double factor = std::pow(10.0, static_cast<int>(random.below(61)) - 30);
      each(table, column,
           [&](double value, std::size_t, const std::string&) { return number(value * factor); });
      break;
    }
    case 3:
      for (auto& row : table.rows)
        if (std::ptrdiff_t(row.size()) > column) row.erase(row.begin() + column);
      break;
    case 4:
      for (auto& row : table.rows)
        if (std::ptrdiff_t(row.size()) > column)
          row.insert(row.begin() + column, std::string(row[std::size_t(column)]));
      break;
    case 5:
      each(table, column,
           [](double, std::size_t row, const std::string&) { return row % 2 == 0 ? "" : "nan"; });
      break;
    case 6:
      each(table, column, [](double value, std::size_t row, const std::string&) {
        return number(row % 7 == 0 ? 1e6 * value : value);
      });
      break;
    default:
      each(table, column, [](double, std::size_t, const std::string&) { return "0"; });
  }
}

/// Entries that are difficult for a solver: zero, huge, tiny, asymmetric, of another sign,
/// singular.
void change_all(Table& table, Random& random) {
  const auto power = std::pow(10.0, static_cast<int>(random.below(41)) - 20);
  const std::size_t how = random.below(6);
  each(table, -1, [&](double value, std::size_t row, const std::string& cell) -> std::string {
    switch (how) {
      case 0:
        return "0";
      case 1:
        return number(-value);
      case 2:
        return number(value * power);
      case 3:
        return number(row == 0 ? value : 0);
      case 4:
        return "1";
      default:
        return row % 2 == 0 ? cell : number(value * power);
    }
  });
}

void change_rows(Table& table, Random& random) {
  auto& rows = table.rows;
  const std::size_t a = random.below(rows.size()), b = random.below(rows.size());
  const auto at = [&](std::size_t i) { return rows.begin() + static_cast<std::ptrdiff_t>(i); };
  switch (random.below(7)) {
    case 0:
      rows.erase(at(a));
      break;
    case 1:
      rows.insert(at(b), std::vector<std::string>(rows[a]));
      break;
    case 2:
      std::swap(rows[a], rows[b]);
      break;
    case 3:
      rows.erase(at(std::min(a, b)), at(std::max(a, b)));
      break;
    case 4:
      std::reverse(at(std::min(a, b)), at(std::max(a, b)));
      break;
    case 5:
      rows.resize(std::min<std::size_t>(rows.size(), 1 + random.below(12)));
      break;
    default: {
      const auto row = rows[a];
      rows.insert(at(a), random.percent(70) ? 3 : 300, row);
    }
  }
}

void change_cell(Table& table, Random& random) {
  auto& row = table.rows[random.below(table.rows.size())];
  const std::size_t at = random.below(row.size());
  switch (random.below(6)) {
    case 0:
      row.erase(row.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      row.insert(row.begin() + static_cast<std::ptrdiff_t>(at), random.of(odd_numbers()));
      break;
    case 2:
      row[at] = random.of(odd_texts());
      break;
    default:
      row[at] = random.of(odd_numbers());
  }
}

}  // namespace

void change_numbers(std::string& text, Random& random) {
  Table table = table_of(text);
  if (table.rows.empty()) {
    text = random.of(odd_numbers()) + "\n";
    return;
  }
  switch (random.below(6)) {
    case 0:
      change_all(table, random);
      break;
    case 1:
      change_rows(table, random);
      break;
    case 2:
      change_column(table, random);
      break;
    case 3:
      table.separator = random.of(std::string(",; \t|"));
      break;
    default:
      change_cell(table, random);
  }
  text = table.text();
}

}  // namespace quadtune::mutations
