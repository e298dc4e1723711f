// SPDX-License-Identifier: Apache-2.0
/// Linear-quadratic regulators: continuous, discrete, and sampled with the exact continuous cost,
/// with integral action on any listed states.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// Weights of the cost ∫ xᵀQx + uᵀRu + 2xᵀNu dt, or of the sum over the samples of a discrete
/// plant.
struct LqrWeights {
  Eigen::MatrixXd Q;  ///< (nx × nx) symmetric, ≥ 0 [1/unit²]
  Eigen::MatrixXd R;  ///< (nu × nu) symmetric, > 0 [1/unit²]
  Eigen::MatrixXd N;  ///< (nx × nu), or empty for zero
};

/// Minimizes the integral of the cost. In the result, K is the gain of u = -K x and X is the cost
/// matrix: xᵀXx is the minimum cost from the initial state x.
///
/// @param plant    nx states, nu inputs; state names are used by the culprit
/// @param weights  for the states and inputs of this plant
/// @param options  of the Riccati equation. Its state_names are those of the plant unless given;
///                 its problem is always the regulator. RiccatiEvidence::essential suits searches,
///                 which solve thousands of problems
/// @throws InvalidInput  for wrong shapes, entries that are not finite, asymmetric or indefinite
///                       weights, and options out of range.
[[nodiscard]] RiccatiResult lqr(const ContinuousLti& plant, const LqrWeights& weights,
                                const RiccatiOptions& options = {});

/// Minimizes the sum of the cost over the samples. The weights apply to each step.
[[nodiscard]] RiccatiResult lqr(const DiscreteLti& plant, const LqrWeights& weights,
                                const RiccatiOptions& options = {});

/// A discrete problem whose cost equals that of a continuous problem with inputs held between
/// samples.
struct SampledLqr {
  DiscreteLti plant;   ///< zero-order hold of the continuous plant
  LqrWeights weights;  ///< Q_d, R_d, N_d; N_d is not small at flight-control rates
};

/// Samples a continuous problem exactly.
/// @param plant    nx states, nu inputs
/// @param weights  of the integral of the cost
/// @param dt       sample period [s], > 0
/// @throws InvalidInput  as validate() and sampled_cost()
/// Source: Van Loan 1978.
[[nodiscard]] SampledLqr sample(const ContinuousLti& plant, const LqrWeights& weights, double dt);

/// Appends ∫ of the listed states to the plant, as states named "int_x" with unit "m s".
///
/// @param plant       nx states, all named
/// @param integrated  names of states of `plant`
/// @throws InvalidInput  if a name is not a state or is listed twice.
[[nodiscard]] ContinuousLti with_integrals(const ContinuousLti& plant,
                                           const std::vector<std::string>& integrated);

/// Returns the weights of the augmented plant: diag(Q, Q_integral), R, and N with zero rows for the
/// integrals.
///
/// @param weights     of the plant without integrals
/// @param Q_integral  (ni × ni) symmetric, ≥ 0
/// @throws InvalidInput  if Q_integral is not square; lqr() validates the rest
[[nodiscard]] LqrWeights with_integral_weights(const LqrWeights& weights,
                                               const Eigen::Ref<const Eigen::MatrixXd>& Q_integral);

}  // namespace quadtune
