// SPDX-License-Identifier: Apache-2.0
/// Measures the time of work that is long enough for a clock: wall time or processor time.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>
#include <vector>

namespace quadtune::bench {

/// @param values  at least one
[[nodiscard]] inline double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Times of several repetitions [s].
struct Wall {
  double median = 0;
  double min = 0;
};

/// @param now  a clock [s]
template <class Work, class Clock>
[[nodiscard]] Wall time_of(Work&& work, std::size_t repetitions, Clock&& now) {
  std::vector<double> seconds;
  seconds.reserve(repetitions);
  for (std::size_t i = 0; i < repetitions; ++i) {
    const double start = now();
    work();
    seconds.push_back(now() - start);
  }
  const double min = *std::min_element(seconds.begin(), seconds.end());
  return {median_of(std::move(seconds)), min};
}

template <class Work>
[[nodiscard]] Wall wall_of(Work&& work, std::size_t repetitions = 15) {
  return time_of(work, repetitions, [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  });
}

/// Processor time, which is affected least by other load on the machine.
template <class Work>
[[nodiscard]] Wall processor_time_of(Work&& work, std::size_t repetitions = 15) {
  return time_of(work, repetitions, [] {
    timespec spent{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
    return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
  });
}

}  // namespace quadtune::bench
