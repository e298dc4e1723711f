// SPDX-License-Identifier: Apache-2.0
/// Named channels of a log, whole, in memory that is a file's where they are long.
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

/// One channel with its clock. Samples without a value (NaN) are left out.
struct LogSeries {
  std::string name;     ///< "group.channel"
  std::string unit;     ///< "" where the log does not say
  bool timed = true;    ///< false: `time` counts the rows, 0, 1, 2, …
  Samples time = {};    ///< [s] after LogChannels::epoch_s
  Samples values = {};  ///< as many
};

struct LogChannels {
  std::vector<LogSeries> series;  ///< in the order of the names that were asked for
  LogCondition condition;
  std::int64_t epoch_s = 0;
  std::vector<LogGroup> groups;  ///< all that the log has
};

/// A channel was asked for that the log does not have; where() is the log.
class UnknownChannel : public InvalidInput {
 public:
  /// @param log      its file
  /// @param problem  e.g. "has no channel 'pz', expected one of px py"
  UnknownChannel(const std::string& log, std::string problem)
      : InvalidInput(log, problem), problem_(std::move(problem)) {}

  /// What is wrong with the log: what() without the file.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string problem_;
};

/// Reads channels of a log in one pass.
/// @param names  "group.channel", or "channel" where only one group has it; of a text also the
///               number of a column, from 1.
/// @param optional  further names that the log need not have: their series follow in this order,
///               without name or samples where it does not
/// @throws UnknownChannel  for a name that the log does not have, with the nearest that it has
/// @throws InvalidInput  for one that stands in several groups; for a log whose times are of an
///                       unknown unit; and as open_log().
/// @throws FileError     as open_log().
[[nodiscard]] LogChannels read_log_channels(const std::string& path,
                                            const std::vector<std::string>& names,
                                            const LogOptions& options = {},
                                            const std::vector<std::string>& optional = {});

/// The series at other times, interpolated between its samples: a series without sample at those
/// times that lie outside of it or between two samples more than ten of its median steps apart.
/// @param series  times increasing
/// @param times   increasing [s], of the same epoch
[[nodiscard]] LogSeries interpolated(const LogSeries& series, const Samples& times);

/// Refuses what no method can use, in one line that begins with `where`: no time, fewer than
/// `least` samples (all NaN included), time that does not increase.
/// @throws InvalidInput
void require_usable(const LogSeries& series, const std::string& where, std::size_t least = 2);

/// Refuses a unit that the log states and that is another than `unit`; "rad s^-1" is "rad/s".
/// @throws InvalidInput
void require_unit(const LogSeries& series, const std::string& unit, const std::string& where);

}  // namespace quadtune
