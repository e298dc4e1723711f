// SPDX-License-Identifier: Apache-2.0
/// The vector of least norm subject to equations and bounds, used to distribute thrust among
/// rotors.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// Singular values below this fraction of the largest count as zero.
inline constexpr double kRankTolerance = 1e-9;

/// argmin ‖f‖ subject to C f = d, in the least-squares sense if no f satisfies it.
[[nodiscard]] Eigen::VectorXd least_norm(const Eigen::MatrixXd& C, const Eigen::VectorXd& d);

/// argmin ‖f‖ subject to C f = d and low ≤ f ≤ high, entry by entry. If no such f exists, the
/// result satisfies the bounds but not C f = d.
[[nodiscard]] Eigen::VectorXd bounded_least_norm(const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                                                 const Eigen::VectorXd& low,
                                                 const Eigen::VectorXd& high);

}  // namespace quadtune::internal
