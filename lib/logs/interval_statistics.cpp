// SPDX-License-Identifier: Apache-2.0
#include "logs/interval_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace quadtune::internal {
namespace {

constexpr double kGap = 2.5;  // periods
constexpr double kJumpPeriods = 100;
constexpr double kJumpSeconds = 10;
constexpr int kBinsPerOctave = 64;

// Uses the leading bits of the number: cheaper than a logarithm, with bins of 0.8 to 1.6 %.
int bin_of(double interval) {
  int exponent = 0;
  const double mantissa = std::frexp(interval, &exponent);  // in [0.5, 1)
  return exponent * kBinsPerOctave + static_cast<int>((mantissa - 0.5) * 2 * kBinsPerOctave);
}

}  // namespace

void IntervalStatistics::take(double time) {
  least_ = std::min(least_, time);
  max_ = std::max(max_, time);
  if (samples_++ == 0) {
    first_ = previous_ = time;
    return;
  }
  const double interval = time - previous_;
  previous_ = time;
  if (interval == 0) {
    ++duplicates_;
  } else if (interval < 0) {
    ++backwards_;
  } else {
    Bin& bin = bins_[bin_of(interval)];
    ++bin.count;
    bin.sum += interval;
    bin.longest = std::max(bin.longest, interval);
  }
}

LogTiming IntervalStatistics::timing() const {
  LogTiming timing;
  if (samples_ == 0) return timing;
  timing.first_s = first_;
  timing.duration_s = max_ - least_;
  timing.duplicates = duplicates_;
  timing.backwards = backwards_;
  std::uint64_t intervals = 0;
  for (const auto& [place, bin] : bins_) intervals += bin.count;
  if (intervals == 0) return timing;
  std::uint64_t below = 0;
  for (const auto& [place, bin] : bins_) {
    below += bin.count;
    timing.period_s = bin.sum / static_cast<double>(bin.count);
    if (2 * below >= intervals) break;
  }
  Bin steady;
  for (const auto& [place, bin] : bins_) {
    const double mean = bin.sum / static_cast<double>(bin.count);
    if (mean <= kGap * timing.period_s) {
      steady.count += bin.count;
      steady.sum += bin.sum;
      continue;
    }
    timing.gaps += bin.count;
    timing.longest_gap_s = std::max(timing.longest_gap_s, bin.longest);
    if (mean > std::max(kJumpSeconds, kJumpPeriods * timing.period_s)) timing.forwards += bin.count;
  }
  timing.rate_hz = static_cast<double>(steady.count) / steady.sum;
  return timing;
}

}  // namespace quadtune::internal
