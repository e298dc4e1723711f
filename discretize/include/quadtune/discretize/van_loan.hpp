// SPDX-License-Identifier: Apache-2.0
/// Integrals of the matrix exponential: what a continuous cost and a continuous noise become when a
/// computer samples the plant.
#pragma once

#include <Eigen/Core>

namespace quadtune {

/// The zero-order hold of a plant together with the cost over one sample: for inputs held between
/// samples, ∫ xᵀQx + 2xᵀNu + uᵀRu dt over each sample is xᵀQx + 2xᵀNu + uᵀRu of the sample, with
/// the matrices here.
struct SampledCost {
  Eigen::MatrixXd A;  ///< (nx × nx) e^(A dt)
  Eigen::MatrixXd B;  ///< (nx × nu) ∫ e^(Aτ) dτ B
  Eigen::MatrixXd Q;  ///< (nx × nx) symmetric, ≥ 0 where the continuous cost is
  Eigen::MatrixXd R;  ///< (nu × nu) symmetric; > 0 even where the continuous R is only ≥ 0 and seen
  Eigen::MatrixXd N;  ///< (nx × nu); not small at flight-control rates
};

/// @param A   (nx × nx), nx ≥ 1 [1/s times units]
/// @param B   (nx × nu), nu ≥ 1
/// @param Q   (nx × nx) symmetric
/// @param R   (nu × nu) symmetric
/// @param N   (nx × nu), or empty for zero
/// @param dt  Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  for shapes, non-finite entries, asymmetry, dt out of range or so long that
///                       an entry of the result exceeds the range of a double.
/// Source: Van Loan 1978 (what is computed); docs/theory.md, "Discretization" (how).
[[nodiscard]] SampledCost sampled_cost(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                       const Eigen::Ref<const Eigen::MatrixXd>& B,
                                       const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                       const Eigen::Ref<const Eigen::MatrixXd>& R,
                                       const Eigen::Ref<const Eigen::MatrixXd>& N, double dt);

/// What continuous process noise adds to the state over one sample.
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
