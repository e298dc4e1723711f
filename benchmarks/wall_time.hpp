// SPDX-License-Identifier: Apache-2.0
/// Wall time of work that is long enough for a clock.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace quadtune::bench {

/// Of some repetitions [s].
struct Wall {
  double median = 0;
  double least = 0;
};

template <class Work>
[[nodiscard]] Wall wall_of(Work&& work, std::size_t repetitions = 15) {
  std::vector<double> seconds;
  seconds.reserve(repetitions);
  for (std::size_t i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(seconds.begin(), seconds.end());
  return {seconds[repetitions / 2], seconds.front()};
}

}  // namespace quadtune::bench
