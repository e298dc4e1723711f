// SPDX-License-Identifier: Apache-2.0
/// Intervals between times, in memory that does not grow with their number.
#pragma once

#include <cstdint>
#include <limits>
#include <map>

#include "quadtune/logs/log_survey.hpp"

namespace quadtune::internal {

/// Counts intervals in bins of 1 % each, so that the median and what is longer than a multiple of
/// it are known at the end to 1 %.
class IntervalStatistics {
 public:
  /// @param time  Finite [s].
  void take(double time);

  [[nodiscard]] LogTiming timing() const;
  /// The least and greatest time; inf and -inf before the first.
  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] double greatest() const { return greatest_; }

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
  double greatest_ = -std::numeric_limits<double>::infinity();
  std::uint64_t samples_ = 0;
  std::uint64_t duplicates_ = 0;
  std::uint64_t backwards_ = 0;
};

}  // namespace quadtune::internal
