// SPDX-License-Identifier: Apache-2.0
#include "logs/log_clock.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace quadtune::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Limit that keeps differences of whole seconds within the range of an integer.
constexpr double kFarthest = 1e15;  // [s]
constexpr double kMinEpoch = 1e6;   // [s]: up to here a double resolves a tenth of a nanosecond

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

LogTicks leading_ticks(std::string_view& text) {
  std::string_view rest = text;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  const bool negative = rest.starts_with('-');
  const char* const first = rest.data();
  const char* const last = rest.data() + rest.size();
  const auto advance = [&](const char* to) {
    text.remove_prefix(static_cast<std::size_t>(to - text.data()));
  };
  // Digits, optionally followed by a dot and digits, are converted without loss.
  std::int64_t whole = 0;
  const auto [dot, whole_error] = std::from_chars(first, last, whole);
  const bool digits = whole_error == std::errc();
  if (digits && (dot == last || (*dot != '.' && *dot != 'e' && *dot != 'E'))) {
    advance(dot);
    return {whole, 0};
  }
  double value = 0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc() || !std::isfinite(value)) return {0, kNaN};
  advance(end);
  if (!digits) return {0, value};  // "-.5", or more digits than fit in an integer
  const char* digit = dot + 1;
  while (digit < end && is_digit(*digit)) ++digit;
  double fraction = 0;
  if (*dot != '.' || digit != end) {
    whole = std::abs(value) < kFarthest ? static_cast<std::int64_t>(value) : 0;
    return {whole, value - static_cast<double>(whole)};
  }
  if (digit > dot + 1) std::from_chars(dot, end, fraction);
  return {whole, negative ? -fraction : fraction};
}

double LogClock::seconds(const LogTicks& ticks, double ticks_per_s) {
  const auto per_s = static_cast<std::int64_t>(ticks_per_s);
  const std::int64_t whole_s = ticks.whole / per_s;
  const auto left = static_cast<double>(ticks.whole % per_s);
  if (!std::isfinite(ticks.rest) || std::abs(static_cast<double>(whole_s)) > kFarthest)
    return seconds((static_cast<double>(ticks.whole) + ticks.rest) / ticks_per_s);
  if (!epoch_s_) epoch_s_ = std::abs(static_cast<double>(whole_s)) >= kMinEpoch ? whole_s : 0;
  return static_cast<double>(whole_s - *epoch_s_) + (left + ticks.rest) / ticks_per_s;
}

double LogClock::seconds(double time_s) {
  if (!std::isfinite(time_s)) return kNaN;
  if (!epoch_s_)
    epoch_s_ = std::abs(time_s) >= kMinEpoch && std::abs(time_s) < kFarthest
                   ? static_cast<std::int64_t>(time_s)
                   : 0;
  return time_s - static_cast<double>(*epoch_s_);
}

}  // namespace quadtune::internal
