// SPDX-License-Identifier: Apache-2.0
/// Integrals of the matrix exponential: the discrete equivalents of a continuous cost and of
/// continuous noise for a sampled plant.
#pragma once

#include <Eigen/Core>

namespace quadtune {

/// The zero-order hold of a plant and the cost over one sample: for inputs held between samples, ∫
/// xᵀQx + 2xᵀNu + uᵀRu dt over a sample equals xᵀQx + 2xᵀNu + uᵀRu at its start, with the matrices
/// of this struct.
struct SampledCost {
  Eigen::MatrixXd A;  ///< (nx × nx) e^(A dt)
  Eigen::MatrixXd B;  ///< (nx × nu) ∫ e^(Aτ) dτ B
  Eigen::MatrixXd Q;  ///< (nx × nx) symmetric, ≥ 0 if the continuous cost is
  /// (nu × nu) symmetric; can be > 0 even if the continuous R is only ≥ 0.
  Eigen::MatrixXd R;
  Eigen::MatrixXd N;  ///< (nx × nu); not negligible at flight-control rates
};

/// @param A   (nx × nx), nx ≥ 1 [1/s times units]
/// @param B   (nx × nu), nu ≥ 1
/// @param Q   (nx × nx) symmetric
/// @param R   (nu × nu) symmetric
/// @param N   (nx × nu), or empty for zero
/// @param dt  Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  if shapes disagree, an entry is not finite, a weight is not symmetric, or
///                       dt is out of range or so long that an entry of the result exceeds the
///                       range of a double.
/// Source: Van Loan 1978 (definition); docs/theory.md, "Discretization" (algorithm).
[[nodiscard]] SampledCost sampled_cost(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                       const Eigen::Ref<const Eigen::MatrixXd>& B,
                                       const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                       const Eigen::Ref<const Eigen::MatrixXd>& R,
                                       const Eigen::Ref<const Eigen::MatrixXd>& N, double dt);

/// The covariance that continuous process noise adds to the state over one sample.
struct SampledNoise {
  Eigen::MatrixXd A;  ///< (nx × nx) e^(A dt)
  Eigen::MatrixXd Q;  ///< (nx × nx) covariance per step: symmetric, ≥ 0
};

/// Q_d = ∫₀^dt e^(Aτ) Q e^(Aᵀτ) dτ.
///
/// @param A   (nx × nx), nx ≥ 1 [1/s times units]
/// @param Q   (nx × nx) symmetric: spectral density of the noise [unit²/s]
/// @param dt  Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  as sampled_cost().
/// Source: Van Loan 1978.
[[nodiscard]] SampledNoise sampled_noise(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                         const Eigen::Ref<const Eigen::MatrixXd>& Q, double dt);

}  // namespace quadtune
