// SPDX-License-Identifier: Apache-2.0
/// Between transfer functions and the state-space models by which they are sampled.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune::internal {

/// realize() for sampling every dt seconds. A chain of states hands on at the speed of the slowest
/// pole there; where that is slower than 1/dt, it is speeded up to it. Otherwise the effect of the
/// input on the last state over one sample, (σ dt)ⁿ/n!, is lost in rounding beside that on the
/// first.
[[nodiscard]] ContinuousLti realize_for_sampling(const ContinuousTransferFunction& plant,
                                                 double dt);

/// num of num(λ)/den(λ) = C (λI - A)⁻¹ B + D, (n + 1) coefficients in descending powers, n that of
/// den. With the Markov parameters h₀ = D, h_k = C A^(k-1) B it is the polynomial part of
/// den(λ) Σ h_k λ^(-k):
///   num_i = Σ_{j ≤ i} den_j h_{i-j}.
/// Nothing decides here which zeros are at infinity, as it has to where zeros are sought one by
/// one.
///
/// @param C    (1 × nx), or empty for (1)
/// @param den  the poles of A, at least those that are steered and seen
[[nodiscard]] Eigen::VectorXd numerator(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                        const Eigen::MatrixXd& C, const Eigen::MatrixXd& D,
                                        const Eigen::VectorXd& den);

}  // namespace quadtune::internal
