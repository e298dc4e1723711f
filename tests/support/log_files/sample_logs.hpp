// SPDX-License-Identifier: Apache-2.0
/// Logs to write and to read back, and their comparison.
#pragma once

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "quadtune/logs/log_table.hpp"

namespace quadtune::testing {

/// A flight of two rows, as written by hand.
inline LogTable small_log() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {{{"vehicle", "mambo"}, {"seed", "7"}},
          {{"t", "s", {0, 0.005}}, {"x.px", "m", {0.1, -2}}, {"gps.px", "m", {kNone, 3}}},
          {{0.0025, "tilt", "rolled 1.2 rad, more than 1"}}};
}

/// Texts that are difficult for some format: separators, quotes, lines, escapes, text that looks
/// like a comment, a keyword, a field of the format, two that give the same field name, other
/// alphabets.
inline const std::vector<std::string>& hostile_texts() {
  static const std::vector<std::string> texts = {"a,b",
                                                 "\"",
                                                 "\"quoted\"",
                                                 "a\"b",
                                                 "\n",
                                                 "a\r\nb",
                                                 "\t",
                                                 "\\",
                                                 "\\n",
                                                 "\\x41",
                                                 "#",
                                                 "# event",
                                                 "[",
                                                 "]",
                                                 "a[m]",
                                                 "a]b[",
                                                 " ",
                                                 " a ",
                                                 ".",
                                                 "..",
                                                 "a.",
                                                 ".a",
                                                 "a.b",
                                                 "a-b",
                                                 "a_b",
                                                 "a b.c",
                                                 "end",
                                                 "x.end",
                                                 "units",
                                                 "units.a",
                                                 "about",
                                                 "events",
                                                 "format",
                                                 "t",
                                                 "T",
                                                 "1",
                                                 "1a",
                                                 "_a",
                                                 "nan",
                                                 "-inf",
                                                 "1e5",
                                                 "=1+1",
                                                 "'",
                                                 "%",
                                                 "%s",
                                                 "{}",
                                                 std::string("\0", 1),
                                                 std::string("a\0b", 3),
                                                 "\x01",
                                                 "\x7f",
                                                 "é",
                                                 "é.€",
                                                 "高度",
                                                 "🚁",
                                                 "\ufeff",
                                                 "a\u2028b",
                                                 "one.two.three.four.five.six",
                                                 std::string(64, 'n'),
                                                 std::string(64, 'n') + "m",
                                                 std::string(300, '.'),
                                                 std::string(5000, 'w')};
  return texts;
}

/// A double of any kind: every bit pattern except those of NaN is possible, and NaN itself is
/// frequent.
inline double any_double(std::mt19937_64& random) {
  using Limits = std::numeric_limits<double>;
  switch (random() % 12) {
    case 0:
      return Limits::quiet_NaN();
    case 1:
      return random() % 2 == 0 ? Limits::infinity() : -Limits::infinity();
    case 2:
      return random() % 2 == 0 ? 0.0 : -0.0;
    case 3:
      return Limits::denorm_min() * static_cast<double>(random() % 1000);
    case 4:
      return random() % 2 == 0 ? Limits::max() : Limits::lowest();
    case 5:
      return Limits::min();
    case 6:
      return static_cast<double>(random() % 2000) - 1000;
    case 7:
      return static_cast<double>(random() % 100000) / 1000;
    default: {
      const auto value = std::bit_cast<double>(random());
      return std::isnan(value) ? Limits::quiet_NaN() : value;
    }
  }
}

/// A table of any small size, often with no rows, columns, events or pairs.
inline LogTable random_log(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto text = [&] { return hostile_texts()[random() % hostile_texts().size()]; };
  const auto maybe_text = [&] { return random() % 5 == 0 ? std::string() : text(); };
  LogTable log;
  for (std::size_t i = random() % 6; i > 0; --i) log.about.emplace_back(maybe_text(), maybe_text());
  const std::size_t rows = random() % 5;
  for (std::size_t i = random() % 12; i > 0; --i) {
    std::string name = text();
    if (random() % 2 == 0) name += "." + text();
    if (log.find(name) != nullptr) continue;
    log.columns.push_back({name, maybe_text(), {}});
    for (std::size_t row = 0; row < rows; ++row)
      log.columns.back().values.push_back(any_double(random));
  }
  for (std::size_t i = random() % 4; i > 0; --i)
    log.events.push_back({any_double(random), maybe_text(), maybe_text()});
  return log;
}

/// The bits of a double; all NaN have the same.
inline std::uint64_t bits_of(double value) {
  return std::bit_cast<std::uint64_t>(std::isnan(value) ? std::numeric_limits<double>::quiet_NaN()
                                                        : value);
}

/// Matches a log that is bit for bit the expected one.
MATCHER_P(SameLog, expected, "is that log") {
  const auto different = [&](const std::string& what) {
    *result_listener << "differs in " << what;
    return false;
  };
  if (arg.about != expected.about) return different("about");
  if (arg.columns.size() != expected.columns.size()) return different("the number of columns");
  for (std::size_t i = 0; i < arg.columns.size(); ++i) {
    const LogColumn& column = arg.columns[i];
    const LogColumn& other = expected.columns[i];
    if (column.name != other.name) return different("name '" + column.name + "'");
    if (column.unit != other.unit) return different("unit of " + column.name);
    if (column.values.size() != other.values.size()) return different("rows of " + column.name);
    for (std::size_t row = 0; row < column.values.size(); ++row)
      if (bits_of(column.values[row]) != bits_of(other.values[row]))
        return different("row " + std::to_string(row) + " of " + column.name);
  }
  if (arg.events.size() != expected.events.size()) return different("the number of events");
  for (std::size_t i = 0; i < arg.events.size(); ++i) {
    const LogEvent& event = arg.events[i];
    if (bits_of(event.time) != bits_of(expected.events[i].time) ||
        event.name != expected.events[i].name || event.detail != expected.events[i].detail)
      return different("event " + std::to_string(i));
  }
  return true;
}

}  // namespace quadtune::testing
