// SPDX-License-Identifier: Apache-2.0
#include "simulation/mission/script_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/text_matrix.hpp"
#include "simulation/loop/bounds.hpp"

namespace quadtune::internal {
namespace {

const std::vector<std::string>& known_columns() {
  static const std::vector<std::string> names = {"t_s", "north_m", "east_m", "height_m", "yaw_rad"};
  return names;
}

// The part of a line before its comment, without leading and trailing blanks.
std::string_view content(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  line = line.substr(0, line.find('#'));
  const std::size_t first = line.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_last_not_of(kBlanks) - first + 1);
}

// Offset and number of each line with content.
struct Line {
  std::size_t begin;
  std::size_t end;
  int number;
};
std::vector<Line> lines_with_content(std::string_view text) {
  std::vector<Line> lines;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    ++number;
    if (!content(text.substr(begin, end - begin)).empty()) lines.push_back({begin, end, number});
    begin = end + 1;
  }
  return lines;
}

std::vector<std::string> split_names(std::string_view line) {
  std::vector<std::string> names;
  while (true) {
    const std::size_t comma = line.find(',');
    names.emplace_back(content(line.substr(0, comma)));
    if (comma == std::string_view::npos) return names;
    line.remove_prefix(comma + 1);
  }
}

// Column index of each known name, -1 if it is missing.
std::array<Eigen::Index, 5> find_columns(std::string_view header, const std::string& where) {
  std::array<Eigen::Index, 5> columns;
  columns.fill(-1);
  const std::vector<std::string>& known = known_columns();
  const std::vector<std::string> names = split_names(header);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = std::find(known.begin(), known.end(), names[i]);
    if (at == known.end())
      throw InvalidInput(where, fmt::format("column '{}' is unknown, expected some of {}, "
                                            "separated by commas{}",
                                            printable(names[i]), internal::joined(known, ", "),
                                            did_you_mean(names[i], known)));
    Eigen::Index& column = columns[static_cast<std::size_t>(at - known.begin())];
    if (column >= 0)
      throw InvalidInput(where, fmt::format("column '{}' appears twice, expected once", names[i]));
    column = static_cast<Eigen::Index>(i);
  }
  for (const std::size_t needed : {0, 3})
    if (columns[needed] < 0)
      throw InvalidInput(where, fmt::format("the column '{}' is missing", known[needed]));
  return columns;
}

}  // namespace

Script parse_script_csv(const std::string& text, const std::string& origin,
                        const MissionStart& start, Between between) {
  require_text(text, origin, kScriptFileLimit);
  const std::vector<Line> lines = lines_with_content(text);
  if (lines.size() < 2)
    throw InvalidInput(origin, "has no rows, expected a line of names and one row per time");
  const Line& first = lines.front();
  const std::string_view header =
      content(std::string_view(text).substr(first.begin, first.end - first.begin));
  const std::array<Eigen::Index, 5> columns =
      find_columns(header, fmt::format("{}:{}", origin, first.number));
  // Replace the names by blanks, so that the matrix parser counts the same lines.
  std::string numbers = text;
  std::fill(numbers.begin() + static_cast<std::ptrdiff_t>(first.begin),
            numbers.begin() + static_cast<std::ptrdiff_t>(first.end), ' ');
  const Eigen::MatrixXd table = parse_text_matrix(numbers, origin);
  const auto width = 5 - std::count(columns.begin(), columns.end(), -1);
  if (table.cols() != width)
    throw InvalidInput(
        fmt::format("{}:{}", origin, lines[1].number),
        fmt::format("row has {} numbers, expected {}, one per column", table.cols(), width));

  Script script;
  script.references.reserve(static_cast<std::size_t>(table.rows()));
  for (Eigen::Index row = 0; row < table.rows(); ++row) {
    const std::string where =
        fmt::format("{}:{}", origin, lines[static_cast<std::size_t>(row) + 1].number);
    const auto value = [&](std::size_t column, double fallback, const Range& range) {
      if (columns[column] < 0) return fallback;
      const double number = table(row, columns[column]);
      require_within(number, range, where, known_columns()[column], "");
      return number;
    };
    TimedReference now;
    const double time = value(0, 0, kTimes);
    now.position = {value(1, start.position.x(), kPlaces), value(2, start.position.y(), kPlaces),
                    -value(3, 0, kHeights)};
    now.yaw = value(4, start.yaw, kAngles);
    now.from = now.until = time;
    if (script.references.empty()) {
      if (time != 0)
        throw InvalidInput(where,
                           fmt::format("t_s begins with {}, expected 0 because a flight needs a "
                                       "reference from its beginning",
                                       time));
    } else {
      const double before = script.references.back().until;
      if (time <= before)
        throw InvalidInput(
            where, fmt::format("t_s is {}, expected more than {}, that of the previous row", time,
                               before));
      if (between == Between::ramp) now.from = before;
    }
    script.references.push_back(now);
  }
  return script;
}

}  // namespace quadtune::internal
