// SPDX-License-Identifier: Apache-2.0
/// The matrix exponential and its integral with every rounding bounded.
#pragma once

#include "certify/enclosure.hpp"

namespace quadtune::internal {

/// What a plant does in a time t with its inputs held.
struct EnclosedHold {
  Enclosure Phi;    ///< e^(A t) for every A and t of the enclosures
  Enclosure Gamma;  ///< ∫₀^t e^(Aτ) dτ
};

/// @param A  (nx × nx) [1/s times units];  @param t  [s], may be 0
/// @return   entries that are not finite where the exponential has none
/// Taylor with a bounded remainder at ‖A t‖∞ ≤ 1/2, then doublings.
[[nodiscard]] EnclosedHold enclosed_hold(const Enclosure& A, const NumberEnclosure& t);

/// Bounds, entry by entry, of |e^(A t)| and |∫₀^t e^(Aτ) dτ| for |A| ≤ size and 0 ≤ t ≤ longest.
struct HoldSize {
  Eigen::MatrixXd Phi;
  Eigen::MatrixXd Gamma;
};
[[nodiscard]] HoldSize hold_size(const ConstRef& size, double longest);

/// A bound of |∂²/∂s² e^((Z + s W) t)| at every |Z| ≤ size and 0 ≤ t ≤ longest, where |W| ≤ change.
/// The series of the exponential has no negative coefficient, so that of the sizes bounds it.
[[nodiscard]] Eigen::MatrixXd exponential_curvature(const ConstRef& size, const ConstRef& change,
                                                    double longest);

}  // namespace quadtune::internal
