// SPDX-License-Identifier: Apache-2.0
/// Feasible intervals of one gain of a loop with bounds, with all other gains fixed.
#pragma once

#include <complex>
#include <vector>

namespace quadtune::internal {

/// An interval of the gain, and the frequency [rad/s] of the bound at its end.
struct GainInterval {
  double low = 0;
  double high = 0;
  double w = 0;
};

/// A response α + β g that is affine in the gain g.
struct AffineResponse {
  std::complex<double> alpha;
  std::complex<double> beta;
};

/// Appends the intervals of g > 0 in which |larger|² < |smaller|² + least²: between the roots of a
/// quadratic function of g, or outside them.
void forbid(const AffineResponse& larger, const AffineResponse& smaller, double min, double w,
            std::vector<GainInterval>& forbidden);

/// Computes the feasible intervals of g > 0 in increasing order, without the last one if it has no
/// upper end. Sorts `forbidden`.
/// @param reached  out: the end of the last forbidden interval; infinite if no gain beyond it is
///                 feasible
[[nodiscard]] std::vector<GainInterval> feasible_intervals(std::vector<GainInterval>& forbidden,
                                                           double& reached);

}  // namespace quadtune::internal
