// SPDX-License-Identifier: Apache-2.0
#include "pid/gain_search.hpp"

#include <algorithm>
#include <cmath>

#include "margins/loop_grid.hpp"

namespace quadtune::internal {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Computes the argument of the maximum of f in [low, high] by golden section search, which needs
/// only comparisons.
template <class F>
double golden_section(const F& f, double low, double high, double width) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  auto at_a = f(a);
  auto at_b = f(b);
  while (high - low > width) {
    if (at_a > at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = f(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = f(b);
    }
  }
  return at_a > at_b ? a : b;
}

/// The same around `centre`; repeated from the result while that is at an end of the interval.
template <class F>
double climb_from(const F& f, double centre, double reach, double width) {
  for (int move = 0; move < 20; ++move) {
    const double found = golden_section(f, centre - reach, centre + reach, width);
    if (std::abs(found - centre) < 0.99 * reach) return found;
    centre = found;
  }
  return centre;
}

}  // namespace

bool MaxGain::operator>(const MaxGain& other) const {
  if (status != other.status) return status > other.status;
  return within_bounds() ? log_gain > other.log_gain : violation < other.violation;
}

MaxGain GainSearch::max(const GainPoint& x) {
  ++evaluations_;
  const PidGains base = problem_.gains(x, -kUnbounded);
  forbidden_.clear();
  problem_.forbid_on_grid(base, forbidden_);
  double reached = 0;
  const std::vector<GainInterval> gaps = feasible_intervals(forbidden_, reached);
  if (problem_.is_unlimited(x, reached)) return {GainStatus::within_bounds, 0, kUnbounded};
  for (std::size_t k = gaps.size(); k-- > 0;) {
    const double log_gain = log_end_of(gaps[k], base);
    const PidGains found = problem_.gains(x, log_gain);
    // The gain may also violate a bound between two frequencies of the grid.
    constexpr double kSlack = 1e-7;
    if (!problem_.stable(found) || problem_.excess(found) > kSlack) continue;
    const double load = problem_.load_excess(found);
    if (load > 0) return {GainStatus::load_exceeded, load, log_gain};
    return {GainStatus::within_bounds, 0, log_gain};
  }
  return {GainStatus::out_of_bounds, std::max(problem_.excess(base), 0.0), -kUnbounded};
}

/// Computes the end of a gap: slightly below the minimum over the frequencies around the one whose
/// bound ends it.
double GainSearch::log_end_of(const GainInterval& gap, const PidGains& base) const {
  const auto end = [&](double w) {
    std::vector<GainInterval> here;
    problem_.forbid_at(base, w, here);
    double lowest = 2 * gap.high;  // finite even if nothing is forbidden
    for (const GainInterval& f : here)
      if (f.low > gap.low) lowest = std::min(lowest, f.low);
    return lowest;
  };
  const std::vector<double>& grid = problem_.grid();
  const auto at = std::lower_bound(grid.begin(), grid.end(), gap.w);
  const double before = at == grid.begin() ? *at : *std::prev(at);
  const double after = at + 1 == grid.end() ? *at : *std::next(at);
  constexpr int kBits = 15;  // about 1e-6 of the frequency
  return std::log(std::min(gap.high, lowest_between(end, before, after, kBits).value)) - 1e-9;
}

GainPoint GainSearch::best_of(const std::vector<GainPoint>& points) {
  GainPoint best;
  MaxGain best_gain;
  for (const GainPoint& x : points) {
    const MaxGain found = max(x);
    if (!(found > best_gain)) continue;
    best_gain = found;
    best = x;
  }
  return best;
}

GainPoint GainSearch::climb(GainPoint x, const ClimbRange& range) {
  const auto at_Kd = [&](double log_Kd) -> GainPoint {
    const double inside = std::min(log_Kd, range.log_Kd_max);
    if (range.over_Kp)
      x.log_Kp = climb_from(
          [&](double log_Kp) {
            return max({log_Kp, inside});
          },
          x.log_Kp, range.Kp_reach, range.Kp_width);
    return {x.log_Kp, inside};
  };
  if (range.over_Kd)
    x.log_Kd = climb_from(
        [&](double log_Kd) {
          MaxGain found = max(at_Kd(log_Kd));
          // Decrease the objective beyond the maximum Kd, so that the search returns.
          const double beyond = std::max(0.0, log_Kd - range.log_Kd_max);
          found.log_gain -= beyond;
          found.violation += beyond;
          return found;
        },
        x.log_Kd, range.Kd_reach, range.Kd_width);
  return at_Kd(x.log_Kd);
}

}  // namespace quadtune::internal
