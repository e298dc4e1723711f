// SPDX-License-Identifier: Apache-2.0
#include "logs/clock_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace quadtune::internal {
namespace {

constexpr double kMaxStep = 10;       // [s] between samples of a log
constexpr double kMinStep = 5e-5;     // [s]: 20 kHz
constexpr double kLastSecond = 1e10;  // since 1970: the year 2286
constexpr double kStraySeconds = 10;
constexpr double kStraySteps = 1000;

struct Unit {
  const char* name;
  const char* words;
  double ticks;
  double from, to;  // range of times since 1970: 1973 to 2286
};
constexpr std::array<Unit, 3> kSince1970 = {{{"ms", "milliseconds", 1e3, 1e11, 1e13},
                                             {"us", "microseconds", 1e6, 1e14, 1e16},
                                             {"ns", "nanoseconds", 1e9, 1e17, 1e19}}};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool plausible(double step, double ticks) {
  return step == 0 || (step / ticks >= kMinStep && step / ticks <= kMaxStep);
}

}  // namespace

ClockSample sample_of_clock(const std::vector<double>& times) {
  std::vector<double> set, steps;
  for (const double time : times) {
    if (!std::isfinite(time) || time == 0) continue;
    if (!set.empty() && time > set.back()) steps.push_back(time - set.back());
    set.push_back(time);
  }
  return {median(set), median(steps)};
}

ClockUnit unit_of_clock(const ClockSample& sample) {
  const double time = std::abs(sample.time);
  const double step = sample.step;
  if (time < kLastSecond && step <= kMaxStep) return {1, "s", "is taken as seconds"};
  if (time < kLastSecond)
    return {0, "us",
            fmt::format("in seconds its samples would be {:.6g} s apart; they may be milliseconds, "
                        "microseconds or nanoseconds",
                        step)};
  for (const Unit& unit : kSince1970) {
    if (time < unit.from || time >= unit.to) continue;
    // A clock that starts at 0 reaches 1e11 us in a day and 1e11 ns in two minutes.
    const bool only_ms =
        step > 0 && plausible(step, 1e3) && !plausible(step, 1e6) && !plausible(step, 1e9);
    const bool only_ns = !plausible(step, 1e6) && plausible(step, 1e9);
    if ((unit.ticks == 1e3 && !only_ms) || (unit.ticks == 1e6 && only_ns)) break;
    return {unit.ticks, unit.name,
            fmt::format("is taken as {} since 1970 by its values, such as {:.6g}", unit.words,
                        sample.time)};
  }
  return {0, time < kSince1970[1].from ? "ms" : "ns",
          fmt::format("its values, such as {:.6g}, are not seconds; they may be milliseconds, "
                      "microseconds or nanoseconds",
                      sample.time)};
}

bool is_no_time(const ClockSample& sample, double ticks) {
  return std::abs(sample.time) / ticks >= kLastSecond;
}

std::string name_of_ticks(double ticks) {
  if (ticks == 1) return "s";
  for (const Unit& unit : kSince1970)
    if (ticks == unit.ticks) return unit.name;
  return fmt::format("1/{:g} s", ticks);
}

bool zero_is_stray(const ClockSample& sample, double ticks) {
  const double time = std::abs(sample.time);
  return time > kStraySeconds * ticks && time > kStraySteps * sample.step;
}

}  // namespace quadtune::internal
