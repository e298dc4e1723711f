// SPDX-License-Identifier: Apache-2.0
/// What names of columns say of unit and time.
#pragma once

#include <string>
#include <string_view>

namespace quadtune::internal {

/// "z [m]" taken apart.
struct LogTitle {
  std::string name;      ///< without the unit in brackets; as it is where the unit is its ending
  std::string unit;      ///< "" where none is said
  double ticks = 0;      ///< of a clock, so many a second; 0 for no clock
  bool guessed = false;  ///< a clock that does not state its unit: unit_of_clock() judges it
};

/// Understands "z[m]", "w_x [rad s^-1]", "time(ns)" and the endings of the project's own keys,
/// "height_m", "rate_rad_per_s". A clock is called t, time, timestamp, stamp or ….header.stamp, in
/// any case of letters, with a unit or the ending _s, _ms, _us or _ns; or as TimeUS.
[[nodiscard]] LogTitle title_of(std::string_view text);

/// So many of a unit of time are a second; 0 for what is none.
[[nodiscard]] double ticks_of(std::string_view unit);

/// "rad s^-1" and "rad/s" as "rad/s"; "m s^-2", "m/s²" as "m/s^2". Others stay as they are.
[[nodiscard]] std::string common_unit(std::string_view unit);

/// `text` without blanks at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace quadtune::internal
