// SPDX-License-Identifier: Apache-2.0
/// The top of a smooth function of one variable.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace quadtune::internal {

/// The largest value of f found in [low, high] and its place, by Brent's method (parabolas through
/// the three best points, golden section where they do not help), to within `width`. The top of an
/// f that rises, then falls. A top is flat: its place is known to the root of rounding only, its
/// height to rounding.
template <class F>
std::pair<double, double> brent_maximum(const F& f, double low, double high, double width) {
  constexpr double kGolden = 0.3819660112501051;
  constexpr int kMaxSteps = 200;  // for a width below rounding
  const double least = 0.25 * width;
  // x is the best point, w the second best, v the one before w.
  double x = low + kGolden * (high - low), w = x, v = x;
  double at_x = f(x), at_w = at_x, at_v = at_x;
  double step = 0, before_last = 0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double middle = 0.5 * (low + high);
    if (std::abs(x - middle) <= 2 * least - 0.5 * (high - low)) break;
    bool golden = true;
    if (std::abs(before_last) > least) {
      // The top of the parabola through the three points is at x + p/q.
      const double r = (x - w) * (at_x - at_v), s = (x - v) * (at_x - at_w);
      double p = (x - v) * s - (x - w) * r, q = 2 * (s - r);
      if (q > 0) p = -p;
      q = std::abs(q);
      if (std::abs(p) < std::abs(0.5 * q * before_last) && p > q * (low - x) &&
          p < q * (high - x)) {
        before_last = step;
        step = p / q;
        const double u = x + step;
        if (u - low < 2 * least || high - u < 2 * least) step = std::copysign(least, middle - x);
        golden = false;
      }
    }
    if (golden) {
      before_last = x < middle ? high - x : low - x;
      step = kGolden * before_last;
    }
    const double u = x + (std::abs(step) >= least ? step : std::copysign(least, step));
    const double at_u = f(u);
    if (at_u >= at_x) {
      (u < x ? high : low) = x;
      v = std::exchange(w, std::exchange(x, u));
      at_v = std::exchange(at_w, std::exchange(at_x, at_u));
      continue;
    }
    (u < x ? low : high) = u;
    if (at_u >= at_w || w == x) {
      v = std::exchange(w, u);
      at_v = std::exchange(at_w, at_u);
    } else if (at_u >= at_v || v == x || v == w) {
      v = u;
      at_v = at_u;
    }
  }
  return {at_x, x};
}

}  // namespace quadtune::internal
