// SPDX-License-Identifier: Apache-2.0
/// The matrix exponential and its integral with rigorous bounds of all rounding errors.
#pragma once

#include "certify/enclosure.hpp"

namespace quadtune::internal {

/// The response of a plant in a time t with its inputs held.
struct EnclosedHold {
  Enclosure Phi;    ///< e^(A t) for every A and t of the enclosures
  Enclosure Gamma;  ///< ∫₀^t e^(Aτ) dτ
};

/// Encloses the exponential by a Taylor series with a bounded remainder at ‖A t‖∞ ≤ 1/2, followed
/// by doublings.
/// @param A  (nx × nx) [1/s times units]
/// @param t  [s], may be 0
/// @return   has entries that are not finite if no bound could be computed
[[nodiscard]] EnclosedHold enclosed_hold(const Enclosure& A, const NumberEnclosure& t);

/// Entrywise upper bounds of |e^(A t)| and |∫₀^t e^(Aτ) dτ| for |A| ≤ size and 0 ≤ t ≤ longest.
struct HoldSize {
  Eigen::MatrixXd Phi;
  Eigen::MatrixXd Gamma;
};
[[nodiscard]] HoldSize hold_size(const ConstRef& size, double longest);

/// Computes an upper bound of |∂²/∂s² e^((Z + s W) t)| for |Z| ≤ size, 0 ≤ t ≤ longest and
/// |W| ≤ change. The series of the exponential has no negative coefficients, so that the series of
/// the absolute values is a bound.
[[nodiscard]] Eigen::MatrixXd exponential_curvature(const ConstRef& size, const ConstRef& change,
                                                    double longest);

}  // namespace quadtune::internal
