// SPDX-License-Identifier: Apache-2.0
/// Necessary conditions for a gain to be an LQR gain, evaluated independently of the search for its
/// weights.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/synthesis/diagonal_lqr.hpp"

namespace quadtune::internal {

/// Peak value and its frequency.
struct SensitivityPeak {
  double value = 0;
  double at = 0;  ///< [rad/s]
};

/// Computes the largest singular value of R₀^½ (I + L)⁻¹ S^-½ over frequencies, L = K (λI - A)⁻¹ B
/// and S = R + BᵀXB of the solution (continuous: R). R₀ is the part of R that consists of the
/// weights of the inputs alone. The value is at most 1 for an LQR gain, as
/// (I + L)ᴴ S (I + L) = R₀ + a cost of the states ≥ 0.
/// Source: Kalman 1964; discrete: Anderson and Moore 1989.
[[nodiscard]] SensitivityPeak weighted_sensitivity(const DiagonalLqr& problem,
                                                   const Eigen::VectorXd& w,
                                                   const RiccatiResult& solution,
                                                   const Eigen::MatrixXd& K);

/// Largest relative excess cost of K over the solution for an initial deviation of one state alone.
struct ExcessCost {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< relative
  Eigen::Index state = 0;
  std::string culprit;  ///< why there is no value; empty if there is one
};
/// @param K  stabilizing; at the stability limit the cost is unbounded and there is no value
[[nodiscard]] ExcessCost excess_cost(const DiagonalLqr& problem, const Eigen::VectorXd& w,
                                     const RiccatiResult& solution, const Eigen::MatrixXd& K);

}  // namespace quadtune::internal
