// SPDX-License-Identifier: Apache-2.0
/// What a flight recorded: columns of numbers over one clock, and events.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace quadtune {

/// One recorded quantity. A row without a value holds NaN.
struct LogColumn {
  std::string name;            ///< e.g. "x.px", "estimate.roll"; letters, digits, '_' and '.'
  std::string unit;            ///< e.g. "m/s"; "1" for counts and truth values
  std::vector<double> values;  ///< one a row
};

/// Something that happened between rows or at one.
struct LogEvent {
  double time = 0;     ///< [s]
  std::string name;    ///< one word, e.g. "tilt"
  std::string detail;  ///< a sentence for a person; may be empty
};

/// A flight, or any other record. All columns have as many rows.
struct LogTable {
  /// What is known of it beside the numbers, in order: vehicle, mission, seed, …
  std::vector<std::pair<std::string, std::string>> about;
  std::vector<LogColumn> columns;  ///< the first is the time, "t" in s, increasing
  std::vector<LogEvent> events;    ///< in the order of their times

  [[nodiscard]] std::size_t rows() const {
    return columns.empty() ? 0 : columns.front().values.size();
  }
  /// The column of that name; nullptr where there is none.
  [[nodiscard]] const LogColumn* find(const std::string& name) const {
    for (const LogColumn& column : columns)
      if (column.name == name) return &column;
    return nullptr;
  }
};

}  // namespace quadtune
