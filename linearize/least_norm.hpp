// SPDX-License-Identifier: Apache-2.0
/// The shortest vector that satisfies equations and bounds: how thrust is shared among rotors.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// Singular values below this share of the greatest count as zero.
inline constexpr double kRankTolerance = 1e-9;

/// argmin ‖f‖ over C f = d, in the least-squares sense where no f meets it.
[[nodiscard]] Eigen::VectorXd least_norm(const Eigen::MatrixXd& C, const Eigen::VectorXd& d);

/// argmin ‖f‖ over C f = d and low ≤ f ≤ high, entry by entry. Where no such f exists the result is
/// within the bounds but leaves C f - d ≠ 0.
[[nodiscard]] Eigen::VectorXd bounded_least_norm(const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                                                 const Eigen::VectorXd& low,
                                                 const Eigen::VectorXd& high);

}  // namespace quadtune::internal
