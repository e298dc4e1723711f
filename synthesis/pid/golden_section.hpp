// SPDX-License-Identifier: Apache-2.0
/// The top of a function of one variable that may have a ridge, where two limits meet.
#pragma once

#include <cmath>
#include <utility>

namespace quadtune::internal {

/// The largest value of f found in [low, high] and its place, by golden section until the interval
/// is no wider than `width`. The top of an f that rises, then falls. A top is flat: its place is
/// known to the root of rounding only, its height to rounding.
template <class F>
std::pair<double, double> golden_section(const F& f, double low, double high, double width) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kMaxSteps = 200;  // for a width below rounding
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  double at_a = f(a);
  double at_b = f(b);
  for (int i = 0; i < kMaxSteps && high - low > width; ++i) {
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
  return at_a > at_b ? std::pair{at_a, a} : std::pair{at_b, b};
}

/// The place of a top of f near `centre`: looked for within half a width of it, and as long as it
/// is found at an end, from there again.
template <class F>
double climb_from(const F& f, double centre, double half_width, double width = 1e-6) {
  for (int move = 0; move < 20; ++move) {
    const double found = golden_section(f, centre - half_width, centre + half_width, width).second;
    if (std::abs(found - centre) < 0.99 * half_width) return found;
    centre = found;
  }
  return centre;
}

}  // namespace quadtune::internal
