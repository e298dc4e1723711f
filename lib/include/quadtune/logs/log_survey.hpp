// SPDX-License-Identifier: Apache-2.0
/// Contents and anomalies of a log, computed in one pass and in constant memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/logs/log_reader.hpp"

namespace quadtune {

/// Timing statistics of recorded rows.
struct LogTiming {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< unknown
  double first_s = kNaN;                                                    ///< the first time
  double duration_s = 0;  ///< difference between maximum and minimum time
  /// Median interval, with an error of at most 1 %; NaN with fewer than two samples
  double period_s = kNaN;
  double rate_hz = kNaN;  ///< over the intervals that are not gaps
  /// Number of intervals of more than 2.5 periods, to within 1 % of a period
  std::uint64_t gaps = 0;
  double longest_gap_s = 0;      ///< the longest gap; 0 if there is none
  std::uint64_t duplicates = 0;  ///< number of times equal to the previous one
  std::uint64_t backwards = 0;   ///< number of times before the previous one
  /// Number of intervals of more than 10 s and 100 periods, after which the clock was set
  std::uint64_t forwards = 0;
};

/// Statistics of one channel. Its timing covers the rows in which it has a value.
struct LogChannelSurvey {
  std::size_t group = 0;          ///< index into LogSurvey::groups
  LogChannel channel;             ///< name and unit
  LogTiming timing;               ///< of the rows in which the channel has a value
  std::uint64_t samples = 0;      ///< number of rows with a value
  std::uint64_t nan = 0;          ///< number of rows without a value
  double min = LogTiming::kNaN;   ///< smallest value; NaN if there is none
  double max = LogTiming::kNaN;   ///< largest value; NaN if there is none
  double mean = LogTiming::kNaN;  ///< mean value; NaN if there is none
  /// Standard deviation, with divisor n - 1; NaN with fewer than two samples
  double std = LogTiming::kNaN;
  bool constant = false;  ///< at least two samples, all equal
  /// Length of the longest run of samples at the minimum or maximum value, if the channel otherwise
  /// varies (in at least a quarter of the other samples), the run has at least 20 samples and it
  /// did not start at the beginning of the log; otherwise 0.
  std::uint64_t saturated = 0;
};

/// A group and its rows.
struct LogGroupSurvey {
  LogGroup group;          ///< name and channels
  std::uint64_t rows = 0;  ///< number of rows
  LogTiming timing;        ///< of all rows
};

/// What a log contains.
struct LogSurvey {
  std::string format;                  ///< one of log_formats()
  std::int64_t epoch_s = 0;            ///< time 0 of the log in the clock of the file [s]
  double duration_s = 0;               ///< difference between maximum and minimum time in the log
  std::vector<LogGroupSurvey> groups;  ///< in the order of the file
  std::vector<LogChannelSurvey> channels;  ///< of all groups, group by group
  LogCondition condition;                  ///< damage that was found
};

/// Reads the log to its end.
/// @throws InvalidInput, FileError  as LogReader::next()
[[nodiscard]] LogSurvey survey_log(LogReader& reader);

}  // namespace quadtune
