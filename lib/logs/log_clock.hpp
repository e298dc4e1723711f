// SPDX-License-Identifier: Apache-2.0
/// Converts a log's own clock to seconds that a double resolves to the nanosecond.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace quadtune::internal {

/// A time in ticks: an integer part, which keeps all digits of nanoseconds since 1970, and a
/// fraction.
struct LogTicks {
  std::int64_t whole = 0;
  double rest = 0;  ///< fraction of a tick; NaN: no time
};

/// Parses the time at the beginning of `text` and removes it; `rest` is NaN if there is none.
[[nodiscard]] LogTicks leading_ticks(std::string_view& text);

/// Converts ticks to seconds since an epoch, which the first time determines: 0, or the whole
/// seconds of a time of 1e6 s or more.
class LogClock {
 public:
  /// @param epoch_s  the epoch, if it is already known
  explicit LogClock(std::optional<std::int64_t> epoch_s) : epoch_s_(epoch_s) {}

  /// @param ticks_per_s  > 0, an integer
  [[nodiscard]] double seconds(const LogTicks& ticks, double ticks_per_s);
  [[nodiscard]] double seconds(double time_s);
  [[nodiscard]] std::int64_t epoch_s() const { return epoch_s_.value_or(0); }

 private:
  std::optional<std::int64_t> epoch_s_;
};

}  // namespace quadtune::internal
