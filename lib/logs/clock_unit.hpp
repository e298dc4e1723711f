// SPDX-License-Identifier: Apache-2.0
/// What unit the times of a clock are in where the file does not state one: judged by their values.
#pragma once

#include <string>
#include <vector>

namespace quadtune::internal {

/// Typical times of a clock, in its own ticks.
struct ClockSample {
  double time = 0;  ///< median of the times that are not 0; 0 without any
  double step = 0;  ///< median of the steps forward between them; 0 without any
};

/// @param times  Of the first rows, in the order of the file; NaN is no time.
[[nodiscard]] ClockSample sample_of_clock(const std::vector<double>& times);

/// Ticks a second of a clock, or why they cannot be known.
struct ClockUnit {
  double ticks = 0;       ///< 0: ambiguous
  const char* unit = "";  ///< "s", "ms", "us" or "ns"; of an ambiguous clock a likely one
  std::string reason;     ///< e.g. "its values, such as 1.4e18, are nanoseconds since 1970"
};

/// Seconds are taken where samples would be at most 10 s apart and the time is below 1e10 (before
/// the year 2286, if counted from 1970). 1e17 to 1e19 are nanoseconds since 1970, 1e14 to 1e16
/// microseconds, and 1e11 to 1e13 milliseconds where no clock that counts microseconds or
/// nanoseconds from its start would have such steps. Everything else is ambiguous.
[[nodiscard]] ClockUnit unit_of_clock(const ClockSample& sample);

/// At this step and beyond [s] even a clock that is in seconds as a rule may count milliseconds.
inline constexpr double kSlowStep = 1;

/// Whether the typical time, in ticks of so many a second, comes after the year 2286, if counted
/// from 1970: then the unit is another.
[[nodiscard]] bool is_no_time(const ClockSample& sample, double ticks);

/// "s", "ms", "us", "ns", or "1/100 s" of so many ticks a second.
[[nodiscard]] std::string name_of_ticks(double ticks);

/// Whether a time of exactly 0 is one that was never set: the clock stands more than 10 s and 1000
/// steps away from it.
[[nodiscard]] bool zero_is_stray(const ClockSample& sample, double ticks);

}  // namespace quadtune::internal
