// SPDX-License-Identifier: Apache-2.0
/// Finds by bisection where a condition changes.
#pragma once

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

namespace quadtune::internal {

/// Arguments on both sides of the change.
struct Border {
  double holds = 0;
  double fails = 0;
};

/// Bisects the interval between an argument at which the condition holds and one at which it fails,
/// until it is no wider than `tolerance` times its larger end, at most sixty times. The condition
/// is not evaluated at the two given arguments.
template <class Condition>
[[nodiscard]] Border border(const Condition& condition, double holds, double fails,
                            double tolerance) {
  const auto sign = [&](double x) {
    return x == holds ? 1.0 : x == fails ? -1.0 : condition(x) ? 1.0 : -1.0;
  };
  const auto narrow = [&](double low, double high) {
    return high - low <= tolerance * std::max(std::abs(low), std::abs(high));
  };
  boost::uintmax_t steps = 60;
  const auto [low, high] = boost::math::tools::bisect(sign, std::min(holds, fails),
                                                      std::max(holds, fails), narrow, steps);
  return holds < fails ? Border{low, high} : Border{high, low};
}

}  // namespace quadtune::internal
