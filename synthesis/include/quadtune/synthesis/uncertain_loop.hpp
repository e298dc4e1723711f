// SPDX-License-Identifier: Apache-2.0
/// A sampled loop around a plant some of whose numbers, and whose delay, are known up to intervals.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/delay_limit.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// A number of the plant: times A and B it adds to the plant.
struct PlantTerm {
  std::string name;   ///< e.g. "thrust over mass"
  Eigen::MatrixXd A;  ///< (nx × nx); empty means zero
  Eigen::MatrixXd B;  ///< (nx × nu); empty means zero
};

/// ẋ = (A + Σ θ_j A_j) x + (B + Σ θ_j B_j) u, with u from a law that looks at x every law.dt
/// seconds and acts a delay later, until its next output does:
///   u[k] = C i[k] + D x[k],   i[k+1] = A i[k] + B x[k]   with the law's matrices.
/// θ and the delay are constant. The same loop, and the same poles, whether the delay is in the
/// computing, in the acting or in the measuring of all states alike.
///
/// The matrices are taken as they are: what is proved of the loop is proved of these doubles.
struct UncertainLoop {
  ContinuousLti plant;           ///< A (nx × nx), B (nx × nu): what the numbers do not move
  std::vector<PlantTerm> terms;  ///< one for each number
  DiscreteLti law;  ///< A (ni × ni), B (ni × nx), C (nu × ni), D (nu × nx); ni may be 0; dt > 0
};

/// Intervals of the numbers and of the delay.
struct LoopBox {
  Eigen::VectorXd low;    ///< of the numbers
  Eigen::VectorXd high;   ///< likewise, ≥ low
  double delay_low = 0;   ///< [s], ≥ 0
  double delay_high = 0;  ///< [s], ≥ delay_low
};

/// Checks shapes and finiteness.
/// @throws InvalidInput  naming the matrix, its shape and what was expected.
void validate(const UncertainLoop& loop, const std::string& where);
/// Checks one interval for each number, in order, finite, and the delay's.
/// @throws InvalidInput  naming the number, what came and what was expected.
void validate(const LoopBox& box, const UncertainLoop& loop, const std::string& where);

/// One period of the closed loop: states x, i, then u[k-1], u[k-2], … as far as the delay reaches,
/// none where it is 0.
/// @param numbers  θ, one for each term
/// @param delay    [s], 0 … kMostDelayPeriods periods
/// @throws InvalidInput  for sizes, or a delay out of range
[[nodiscard]] Eigen::MatrixXd closed_loop_matrix(const UncertainLoop& loop,
                                                 const Eigen::VectorXd& numbers, double delay);

/// Greatest modulus of the closed loop's poles; below 1 it is stable. Infinite where they could not
/// be computed.
[[nodiscard]] double spectral_radius(const UncertainLoop& loop, const Eigen::VectorXd& numbers,
                                     double delay);

}  // namespace quadtune
