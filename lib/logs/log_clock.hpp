// SPDX-License-Identifier: Apache-2.0
/// A log's own clock as seconds that a double holds to the nanosecond.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace quadtune::internal {

/// A time in ticks: whole ones, which keep all digits of nanoseconds since 1970, and the rest.
struct LogTicks {
  std::int64_t whole = 0;
  double rest = 0;  ///< of a tick; NaN: no time at all
};

/// The time at the start of `text`, which moves behind it; the rest is NaN where there is none.
[[nodiscard]] LogTicks leading_ticks(std::string_view& text);

/// Turns ticks into seconds after an epoch, which the first time decides: 0, or the whole seconds
/// of a time of 1e6 s or more.
class LogClock {
 public:
  /// @param epoch_s  The epoch where it is decided already.
  explicit LogClock(std::optional<std::int64_t> epoch_s) : epoch_s_(epoch_s) {}

  /// @param ticks_per_s  > 0, a whole number.
  [[nodiscard]] double seconds(const LogTicks& ticks, double ticks_per_s);
  [[nodiscard]] double seconds(double time_s);
  [[nodiscard]] std::int64_t epoch_s() const { return epoch_s_.value_or(0); }

 private:
  std::optional<std::int64_t> epoch_s_;
};

}  // namespace quadtune::internal
