// SPDX-License-Identifier: Apache-2.0
/// Reads named channels of a log as a whole. Long channels are stored in memory-mapped files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/samples.hpp"

namespace quadtune {

/// One channel with its times. Samples without a value (NaN) are omitted.
struct LogSeries {
  std::string name;     ///< "group.channel"
  std::string unit;     ///< empty if the log does not state it
  bool timed = true;    ///< false: `time` contains the row numbers 0, 1, 2, …
  Samples time = {};    ///< [s] since LogChannels::epoch_s
  Samples values = {};  ///< same length as time
};

/// Series of a log, and the state of the log.
struct LogChannels {
  std::vector<LogSeries> series;  ///< in the order of the requested names
  LogCondition condition;         ///< damage that was found
  std::int64_t epoch_s = 0;       ///< time 0 of the series in the clock of the file [s]
  std::vector<LogGroup> groups;   ///< all groups of the log
};

/// A requested channel does not exist in the log; where() is the log.
class UnknownChannel : public InvalidInput {
 public:
  /// @param log      file name of the log
  /// @param problem  e.g. "has no channel 'pz', expected one of px py"
  UnknownChannel(const std::string& log, std::string problem)
      : InvalidInput(log, problem), problem_(std::move(problem)) {}

  /// The message without the file name.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string problem_;
};

/// Reads channels of a log in one pass.
/// @param path     of the log
/// @param names    "group.channel", or "channel" if only one group has it; for text also the number
///                 of a column, from 1
/// @param options  format, columns and clock, if they are not detected
/// @param optional  further names that the log may not have. Their series follow in this order; the
///                  series of a missing channel has neither name nor samples
/// @throws UnknownChannel  if the log does not have a channel, with the most similar existing name
/// @throws InvalidInput  if several groups have a channel of that name; if the unit of the log's
///                       times is unknown; and as open_log()
/// @throws FileError     as open_log()
[[nodiscard]] LogChannels read_log_channels(const std::string& path,
                                            const std::vector<std::string>& names,
                                            const LogOptions& options = {},
                                            const std::vector<std::string>& optional = {});

/// Interpolates a series linearly at other times. Times outside the series, or between two samples
/// more than ten median steps apart, are omitted.
/// @param series  times strictly increasing
/// @param times   increasing [s], with the same epoch
[[nodiscard]] LogSeries interpolated(const LogSeries& series, const Samples& times);

/// Rejects a series that no method can use, with a one-line message that begins with `where`: no
/// times, fewer than `min` samples (NaN not counted), or times that do not increase.
/// @throws InvalidInput
void require_usable(const LogSeries& series, const std::string& where, std::size_t min = 2);

/// Rejects a series whose stated unit differs from `unit`; "rad s^-1" equals "rad/s".
/// @throws InvalidInput
void require_unit(const LogSeries& series, const std::string& unit, const std::string& where);

}  // namespace quadtune
