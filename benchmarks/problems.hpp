// SPDX-License-Identifier: Apache-2.0
/// The plants and weights of the benchmarks: seeded, so that every run has the same.
#pragma once

#include <Eigen/Core>

namespace quadtune::bench {

/// A linear-quadratic problem, continuous or discrete depending on its use.
struct Problem {
  Eigen::MatrixXd A;  ///< (nx × nx)
  Eigen::MatrixXd B;  ///< (nx × nu)
  Eigen::MatrixXd Q;  ///< (nx × nx), > 0
  Eigen::MatrixXd R;  ///< (nu × nu), > 0
};

/// Gaussian A with eigenvalues filling the unit disk about 0, one input for every three states,
/// Q and R the identity: well conditioned at any size.
[[nodiscard]] Problem random_problem(Eigen::Index nx);

/// The hover of a 63 g quadrotor in plain SI units, 12 states, thrust and torques as inputs:
/// entries of B reach 2e4, compared with g = 9.81. Bryson weights: 0.1 m, 0.1 rad, 0.5 m/s, 1 rad/s
/// relative to 0.1 N and 1 mN m.
[[nodiscard]] Problem hover_problem();

/// The same with the integrals of x, y, z and yaw: 16 states.
[[nodiscard]] Problem hover_with_integrals();

/// The same hovers with all weights 1, so that the weights do not compensate for the units: ‖Q‖ :
/// ‖G‖ is 1 : 3e8.
[[nodiscard]] Problem unit_weights(Problem problem);

}  // namespace quadtune::bench
