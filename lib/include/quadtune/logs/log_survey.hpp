// SPDX-License-Identifier: Apache-2.0
/// What is in a log and what is odd about it, in one pass and in memory that does not grow with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/logs/log_reader.hpp"

namespace quadtune {

/// When something was recorded.
struct LogTiming {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  double first_s = kNaN;         ///< the first time
  double duration_s = 0;         ///< from the least time to the greatest
  double period_s = kNaN;        ///< the median interval, to 1 %; NaN with fewer than two samples
  double rate_hz = kNaN;         ///< over the intervals that are no gaps
  std::uint64_t gaps = 0;        ///< intervals of more than 2.5 periods, to 1 % of a period
  double longest_gap_s = 0;      ///< the longest of them; 0 without
  std::uint64_t duplicates = 0;  ///< times equal to the one before
  std::uint64_t backwards = 0;   ///< times before the one before
  std::uint64_t forwards = 0;    ///< intervals of more than 10 s and 100 periods: the clock was set
};

/// One channel. Its timing is that of the rows in which it has a value.
struct LogChannelSurvey {
  std::size_t group = 0;  ///< in LogSurvey::groups
  LogChannel channel;
  LogTiming timing;
  std::uint64_t samples = 0;  ///< rows with a value
  std::uint64_t nan = 0;      ///< rows without
  double min = LogTiming::kNaN;
  double max = LogTiming::kNaN;
  double mean = LogTiming::kNaN;
  double std = LogTiming::kNaN;  ///< with n - 1; NaN with fewer than two samples
  bool constant = false;         ///< two samples or more, all equal
  /// The longest run of samples at the least or greatest value, where the channel moves otherwise
  /// (in a quarter or more of the other samples), the run has 20 or more and did not begin with the
  /// log; else 0.
  std::uint64_t saturated = 0;
};

struct LogGroupSurvey {
  LogGroup group;
  std::uint64_t rows = 0;
  LogTiming timing;  ///< of all rows
};

struct LogSurvey {
  std::string format;
  std::int64_t epoch_s = 0;
  double duration_s = 0;  ///< from the least time in the log to the greatest
  std::vector<LogGroupSurvey> groups;
  std::vector<LogChannelSurvey> channels;  ///< group after group
  LogCondition condition;
};

/// Reads the log to its end.
/// @throws InvalidInput, FileError  as LogReader::next().
[[nodiscard]] LogSurvey survey_log(LogReader& reader);

}  // namespace quadtune
