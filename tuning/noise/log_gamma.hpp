// SPDX-License-Identifier: Apache-2.0
/// The logarithm of the gamma function, for use by several threads.
#pragma once

#include <cmath>

namespace quadtune::internal {

/// log Γ(x), x > 0. std::lgamma() writes the sign of Γ to a global variable, which is a data race
/// if two threads call it.
inline double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace quadtune::internal
