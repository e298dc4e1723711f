// SPDX-License-Identifier: Apache-2.0
/// Infers the unit of a clock from its values if the file does not state it.
#pragma once

#include <string>
#include <vector>

namespace quadtune::internal {

/// Typical time and step of a clock, in its own ticks.
struct ClockSample {
  double time = 0;  ///< median of the times that are not 0; 0 if there are none
  double step = 0;  ///< median of the positive steps between them; 0 if there are none
};

/// @param times  of the first rows, in the order of the file; NaN is ignored
[[nodiscard]] ClockSample sample_of_clock(const std::vector<double>& times);

/// Ticks per second of a clock, or the reason why they are unknown.
struct ClockUnit {
  double ticks = 0;       ///< 0: ambiguous
  const char* unit = "";  ///< "s", "ms", "us" or "ns"; for an ambiguous clock, a likely unit
  std::string reason;     ///< e.g. "its values, such as 1.4e18, are nanoseconds since 1970"
};

/// Infers the unit of a clock. It is seconds if samples would be at most 10 s apart and the time is
/// below 1e10 (before the year 2286, if counted from 1970). Values from 1e17 to 1e19 are
/// nanoseconds since 1970, 1e14 to 1e16 microseconds, and 1e11 to 1e13 milliseconds unless a clock
/// that counts microseconds or nanoseconds from its start could have such steps. All other values
/// are ambiguous.
[[nodiscard]] ClockUnit unit_of_clock(const ClockSample& sample);

/// At steps of at least this size [s], even a clock that is usually in seconds may count
/// milliseconds.
inline constexpr double kSlowStep = 1;

/// Whether the typical time, with so many ticks per second, is after the year 2286 if counted from
/// 1970; the unit is then wrong.
[[nodiscard]] bool is_no_time(const ClockSample& sample, double ticks);

/// Name of a unit by its ticks per second: "s", "ms", "us", "ns", or e.g. "1/100 s".
[[nodiscard]] std::string name_of_ticks(double ticks);

/// Whether a time of exactly 0 means an unset clock: the typical time is more than 10 s and 1000
/// steps away from 0.
[[nodiscard]] bool zero_is_stray(const ClockSample& sample, double ticks);

}  // namespace quadtune::internal
