// SPDX-License-Identifier: Apache-2.0
/// Whether the covariance of a filter has converged, judged from how much it changes.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace quadtune::internal {

/// Looks at a covariance every kEvery steps. Near its limit the changes from look to look shrink by
/// a constant factor, so that what is still to come is the sum of a geometric series.
class Convergence {
 public:
  static constexpr Eigen::Index kEvery = 16;   ///< steps between looks
  static constexpr double kTolerance = 1e-13;  ///< relative distance from the limit

  /// @param change  largest change since the last look, relative to the standard deviations;
  ///                infinite where a variance has become exactly 0
  /// @return        whether the limit is nearer than kTolerance
  bool reached(double change) {
    // No factor follows from an infinite change: it would be 0, and the covariance of the states
    // that still converge would count as settled.
    const double factor = last_ > 0 && std::isfinite(last_) ? change / last_ : 1;
    last_ = change;
    return change < 1e-16 || (factor < 0.999 && change * factor / (1 - factor) < kTolerance);
  }

 private:
  double last_ = -1;
};

/// Share of R in the innovation's variance S below which what is left of P along C is lost in
/// rounding, so that the whole of Joseph's form is computed.
inline constexpr double kLeastShareOfR = 1e-4;

}  // namespace quadtune::internal
