// SPDX-License-Identifier: Apache-2.0
/// Whether a gain can be an LQR's at all, judged beside the search for its weights.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/synthesis/diagonal_lqr.hpp"

namespace quadtune::internal {

/// A figure and where it is.
struct SensitivityPeak {
  double value = 0;
  double at = 0;  ///< [rad/s]
};

/// Greatest singular value of R₀^½ (I + L)⁻¹ S^-½ over frequencies, L = K (λI - A)⁻¹ B and
/// S = R + BᵀXB of the solution (continuous: R). R₀ is the part of R that the inputs' weights alone
/// make. At most 1 for an LQR gain, as (I + L)ᴴ S (I + L) = R₀ + a cost of the states ≥ 0.
/// Source: Kalman 1964; discrete: Anderson and Moore 1989.
[[nodiscard]] SensitivityPeak weighted_sensitivity(const DiagonalLqr& problem,
                                                   const Eigen::VectorXd& w,
                                                   const RiccatiResult& solution,
                                                   const Eigen::MatrixXd& K);

/// How much more than the solution K costs from a deviation of one state alone, the worst of them.
struct ExcessCost {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< relative
  Eigen::Index state = 0;
  std::string culprit;  ///< why there is no value; empty where there is one
};
/// @param K  stabilizing; on the border of it the cost has no bound, and no value
[[nodiscard]] ExcessCost excess_cost(const DiagonalLqr& problem, const Eigen::VectorXd& w,
                                     const RiccatiResult& solution, const Eigen::MatrixXd& K);

}  // namespace quadtune::internal
