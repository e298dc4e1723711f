// SPDX-License-Identifier: Apache-2.0
/// What bounds on a loop leave of one of its gains when the others stand.
#pragma once

#include <complex>
#include <vector>

namespace quadtune::internal {

/// An interval of the gain, and the frequency [rad/s] whose bound ends it.
struct GainInterval {
  double low = 0;
  double high = 0;
  double w = 0;
};

/// α + β g: a response that moves in proportion to the gain g.
struct AffineResponse {
  std::complex<double> alpha;
  std::complex<double> beta;
};

/// Appends the values of g > 0 at which |larger|² < |smaller|² + least²: between the roots of a
/// quadratic in g, or beyond them.
void forbid(const AffineResponse& larger, const AffineResponse& smaller, double least, double w,
            std::vector<GainInterval>& forbidden);

/// What is left of g > 0, by size. `forbidden` is sorted. The last is left out if nothing ends it.
/// @param reached  receives where the last forbidden interval ends: infinite if none is left beyond
[[nodiscard]] std::vector<GainInterval> gaps_between(std::vector<GainInterval>& forbidden,
                                                     double& reached);

}  // namespace quadtune::internal
