// SPDX-License-Identifier: Apache-2.0
/// Statistics of the intervals between times, in constant memory.
#pragma once

#include <cstdint>
#include <limits>
#include <map>

#include "quadtune/logs/log_survey.hpp"

namespace quadtune::internal {

/// Counts intervals in bins of about 1 % width, so that the median, and the number of intervals
/// longer than a multiple of it, are known at the end to 1 %.
class IntervalStatistics {
 public:
  /// @param time  finite [s]
  void take(double time);

  [[nodiscard]] LogTiming timing() const;
  /// Minimum and maximum time; inf and -inf before the first.
  [[nodiscard]] double min() const { return least_; }
  [[nodiscard]] double max() const { return max_; }

 private:
  struct Bin {
    std::uint64_t count = 0;
    double sum = 0;
    double longest = 0;
  };

  std::map<int, Bin> bins_;  // by the logarithm of the interval
  double first_ = std::numeric_limits<double>::quiet_NaN();
  double previous_ = std::numeric_limits<double>::quiet_NaN();
  double least_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  std::uint64_t samples_ = 0;
  std::uint64_t duplicates_ = 0;
  std::uint64_t backwards_ = 0;
};

}  // namespace quadtune::internal
