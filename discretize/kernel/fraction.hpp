// SPDX-License-Identifier: Apache-2.0
/// Conversions between transfer functions and the state-space models with which they are sampled.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune::internal {

/// realize() with states scaled for sampling every dt seconds. realize() scales its chain of states
/// by the size σ of the largest pole. If σ is below 1/dt, the chain is scaled by 1/dt instead:
/// otherwise the effect of the input on the last state over one sample, (σ dt)ⁿ/n!, would be lost
/// to rounding relative to that on the first.
[[nodiscard]] ContinuousLti realize_for_sampling(const ContinuousTransferFunction& plant,
                                                 double dt);

/// The numerator of num(λ)/den(λ) = C (λI - A)⁻¹ B + D as (n + 1) coefficients in descending
/// powers, where n is the degree of den. With the Markov parameters h₀ = D, h_k = C A^(k-1) B it is
/// the polynomial part of den(λ) Σ h_k λ^(-k):
///   num_i = Σ_{j ≤ i} den_j h_{i-j}.
/// Unlike a computation of the zeros one by one, this does not have to decide which zeros are
/// infinite.
///
/// @param C    (1 × nx), or empty for (1)
/// @param den  the poles of A, at least the controllable and observable ones
[[nodiscard]] Eigen::VectorXd numerator(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                        const Eigen::MatrixXd& C, const Eigen::MatrixXd& D,
                                        const Eigen::VectorXd& den);

}  // namespace quadtune::internal
