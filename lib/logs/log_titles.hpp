// SPDX-License-Identifier: Apache-2.0
/// Parses units and clocks from column names.
#pragma once

#include <string>
#include <string_view>

namespace quadtune::internal {

/// A column title such as "z [m]", split into its parts.
struct LogTitle {
  std::string name;      ///< without the unit in brackets; a unit suffix remains part of the name
  std::string unit;      ///< empty if not stated
  double ticks = 0;      ///< for a clock: ticks per second; 0 otherwise
  bool guessed = false;  ///< a clock without a stated unit; unit_of_clock() infers it
};

/// Parses "z[m]", "w_x [rad s^-1]", "time(ns)" and the suffixes of quadtune's own keys, "height_m",
/// "rate_rad_per_s". A clock is named t, time, timestamp, stamp or ….header.stamp, in upper or
/// lower case, with a unit or the suffix _s, _ms, _us or _ns; or TimeUS.
[[nodiscard]] LogTitle title_of(std::string_view text);

/// Ticks per second of a unit of time, in upper or lower case; 0 if it is none.
[[nodiscard]] double ticks_of(std::string_view unit);

/// Normalizes spellings: "rad s^-1" to "rad/s"; "m s^-2" and "m/s²" to "m/s^2". Other units are
/// unchanged.
[[nodiscard]] std::string common_unit(std::string_view unit);

/// `text` without leading and trailing blanks.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace quadtune::internal
