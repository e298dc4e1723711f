// SPDX-License-Identifier: Apache-2.0
/// A sampled loop around a plant whose delay and some of whose parameters are known only to lie in
/// intervals.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/loop_limits.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// An uncertain parameter θ of the plant: it adds θ A and θ B to the matrices of the plant.
struct PlantTerm {
  std::string name;   ///< e.g. "thrust over mass"
  Eigen::MatrixXd A;  ///< (nx × nx); empty means zero
  Eigen::MatrixXd B;  ///< (nx × nu); empty means zero
};

/// ẋ = (A + Σ θ_j A_j) x + (B + Σ θ_j B_j) u. The law samples x every law.dt seconds; its output is
/// applied after the delay and held until the next output is applied:
///   u[k] = C i[k] + D x[k],   i[k+1] = A i[k] + B x[k]   with the law's matrices.
/// θ and the delay are constant. The poles are the same whether the delay is in the computation, in
/// the actuation, or in the measurement of all states.
///
/// The matrices are used exactly as given: a proof about the loop holds for these doubles.
struct UncertainLoop {
  ContinuousLti plant;           ///< A (nx × nx), B (nx × nu): the certain part
  std::vector<PlantTerm> terms;  ///< one for each parameter
  DiscreteLti law;  ///< A (ni × ni), B (ni × nx), C (nu × ni), D (nu × nx); ni may be 0; dt > 0
};

/// Intervals of the parameters and of the delay.
struct LoopBox {
  Eigen::VectorXd low;    ///< lower bounds of the parameters
  Eigen::VectorXd high;   ///< upper bounds, ≥ low
  double delay_low = 0;   ///< [s], ≥ 0
  double delay_high = 0;  ///< [s], ≥ delay_low
};

/// Checks shapes and finiteness.
/// @throws InvalidInput  naming the matrix, its shape and what was expected.
void validate(const UncertainLoop& loop, const std::string& where);
/// Checks that there is one finite interval for each parameter, and that the bounds of all
/// intervals are in order.
/// @throws InvalidInput  naming the parameter, its bounds and the expected value.
void validate(const LoopBox& box, const UncertainLoop& loop, const std::string& where);

/// Computes the matrix of one period of the closed loop. Its states are x, i, and the past outputs
/// u[k-1], u[k-2], … that the delay requires, none if it is 0.
/// @param loop     accepted by validate()
/// @param numbers  θ, one for each term
/// @param delay    [s], 0 … kMaxDelayPeriods periods
/// @throws InvalidInput  if a size is wrong, or the delay is out of range
[[nodiscard]] Eigen::MatrixXd closed_loop_matrix(const UncertainLoop& loop,
                                                 const Eigen::VectorXd& numbers, double delay);

/// Computes the maximum modulus of the closed loop's poles; the loop is stable if it is below 1.
/// Infinite if the poles could not be computed.
[[nodiscard]] double spectral_radius(const UncertainLoop& loop, const Eigen::VectorXd& numbers,
                                     double delay);

}  // namespace quadtune
