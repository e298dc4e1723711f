// SPDX-License-Identifier: Apache-2.0
/// Test whether the covariance of a filter has converged, based on its changes.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace quadtune::internal {

/// Checks a covariance every kEvery steps. Close to the limit the changes between checks decrease
/// by a constant factor, so that the remaining change is the sum of a geometric series.
class Convergence {
 public:
  static constexpr Eigen::Index kEvery = 16;   ///< steps between checks
  static constexpr double kTolerance = 1e-13;  ///< relative distance from the limit

  /// @param change  largest change since the last check, relative to the standard deviations;
  ///                infinite if a variance has become exactly 0
  /// @return        whether the distance from the limit is below kTolerance
  bool reached(double change) {
    // An infinite change does not determine the factor: it would be 0, and states whose covariance
    // still converges would count as converged.
    const double factor = last_ > 0 && std::isfinite(last_) ? change / last_ : 1;
    last_ = change;
    return change < 1e-16 || (factor < 0.999 && change * factor / (1 - factor) < kTolerance);
  }

 private:
  double last_ = -1;
};

/// Share of R in the innovation variance S below which the remaining P along C is lost in rounding
/// errors, so that the complete Joseph form is computed.
inline constexpr double kMinShareOfR = 1e-4;

}  // namespace quadtune::internal
