// SPDX-License-Identifier: Apache-2.0
/// Newton's method for the equations of a steady flight; trim() interprets the result.
#pragma once

#include <Eigen/Core>

#include "quadtune/linearize/trim.hpp"
#include "trim_problem.hpp"

namespace quadtune::internal {

/// The outcome of Newton's method.
struct NewtonResult {
  Eigen::VectorXd z;
  double residual = 0;  ///< largest entry of the balance
  int iterations = 0;
  /// Degrees of freedom of the thrusts beyond the four that the balance determines.
  Eigen::Index freedom = 0;
};

/// Newton's method from z. Among all balancing thrusts it selects those with the least sum of
/// squares.
/// @param within_limits  whether to bound the thrusts of every step by the motors' limits.
[[nodiscard]] NewtonResult newton(const TrimProblem& problem, Eigen::VectorXd z,
                                  const TrimOptions& options, bool within_limits);

}  // namespace quadtune::internal
