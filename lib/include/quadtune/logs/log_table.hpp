// SPDX-License-Identifier: Apache-2.0
/// A recorded flight: columns of numbers with a common clock, and events.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace quadtune {

/// One recorded quantity. NaN marks a row without a value.
struct LogColumn {
  std::string name;            ///< e.g. "x.px", "estimate.roll"; letters, digits, '_' and '.'
  std::string unit;            ///< e.g. "m/s"; "1" for counts and Boolean values
  std::vector<double> values;  ///< one per row
};

/// An event, with its own time.
struct LogEvent {
  double time = 0;     ///< [s]
  std::string name;    ///< one word, e.g. "tilt"
  std::string detail;  ///< a sentence for the user; may be empty
};

/// A flight or any other record. All columns have the same number of rows.
struct LogTable {
  /// Metadata, in order: vehicle, mission, seed, …
  std::vector<std::pair<std::string, std::string>> about;
  std::vector<LogColumn> columns;  ///< the first is the time, "t" in s, increasing
  std::vector<LogEvent> events;    ///< in chronological order

  /// Number of rows of every column.
  [[nodiscard]] std::size_t rows() const {
    return columns.empty() ? 0 : columns.front().values.size();
  }
  /// The column of that name; nullptr if there is none.
  [[nodiscard]] const LogColumn* find(const std::string& name) const {
    for (const LogColumn& column : columns)
      if (column.name == name) return &column;
    return nullptr;
  }
};

}  // namespace quadtune
