// SPDX-License-Identifier: Apache-2.0
/// Statistics of the norm of a Gaussian error over one flight: its rms, and values that it rarely
/// exceeds.
/// Theory: docs/theory.md, "What the sensors can know".
#pragma once

#include <vector>

#include "quadtune/workbench/flight/filter_covariance.hpp"

namespace quadtune {

/// The share of flights in which an error may exceed its "rarely exceeded" values.
inline constexpr double kRarely = 1e-3;

/// ‖e‖ of an error e(t) over one flight, in the unit of its axes.
struct ErrorSize {
  double rms = 0;          ///< √ of the mean of E‖e‖² over the outputs
  double rms_rarely = 0;   ///< exceeded by the rms of one flight with the probability `share`
  double most_rarely = 0;  ///< exceeded by the maximum of ‖e‖ over one flight with the same
                           ///< probability
  double samples = 0;  ///< degrees of freedom of the rms over one flight; fewer mean more variation
};

/// Computes the statistics of an error whose independent axes have these covariances.
///
/// @param axes     1 to 3, with the same outputs and starts
/// @param times    of the outputs [s], equally spaced
/// @param counted  the outputs that are included; if there are none, all results are 0
/// @param share    0 < share < 1
/// @throws InvalidInput  if the axes do not agree
[[nodiscard]] ErrorSize error_size(const std::vector<ErrorCovariance>& axes,
                                   const std::vector<double>& times,
                                   const std::vector<bool>& counted, double share = kRarely);

/// The value that ‖e‖ exceeds with the probability `share` at one instant.
/// @param variances  of the independent axes [unit²], ≥ 0
/// @param share      probability, 0 < share < 1
[[nodiscard]] double rarely_exceeded(const std::vector<double>& variances, double share = kRarely);

}  // namespace quadtune
