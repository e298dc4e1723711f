// SPDX-License-Identifier: Apache-2.0
// Parser of column selections: "t_s:1, t_us:2, height[m]:19".
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "logs/log_titles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune {
namespace {

using internal::LogTitle;
using internal::printable;
using internal::trimmed;

LogColumnChoice choice_of(std::string_view item, const std::string& where) {
  if (item == "*") return {};
  // A colon within brackets is part of the unit.
  const std::size_t bracket = item.rfind(']');
  const std::size_t colon = item.find(':', bracket == std::string_view::npos ? 0 : bracket);
  const LogTitle title = internal::title_of(item.substr(0, colon));
  LogColumnChoice choice{title.name, title.unit, "", title.ticks};
  if (colon != std::string_view::npos) choice.column = trimmed(item.substr(colon + 1));
  if (choice.name.empty() || (colon != std::string_view::npos && choice.column.empty()))
    throw InvalidInput(where,
                       fmt::format("'{}' is not a column, expected NAME[UNIT]:COLUMN such as "
                                   "height[m]:19, a name alone, or * for all others",
                                   printable(item)));
  return choice;
}

}  // namespace

std::vector<LogColumnChoice> parse_log_columns(const std::string& text, const std::string& where) {
  std::vector<LogColumnChoice> choices;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = rest.find(',');
    const LogColumnChoice choice = choice_of(trimmed(rest.substr(0, comma)), where);
    const bool twice = std::any_of(choices.begin(), choices.end(), [&](const auto& other) {
      return other.name == choice.name && choice.ticks == other.ticks;
    });
    if (twice)
      throw InvalidInput(where, fmt::format("'{}' is given twice, expected each name once",
                                            choice.name.empty() ? "*" : printable(choice.name)));
    choices.push_back(choice);
    if (comma == std::string_view::npos) return choices;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace quadtune
