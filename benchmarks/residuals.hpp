// SPDX-License-Identifier: Apache-2.0
/// Residuals of results, evaluated in extended precision so that their rounding errors do not
/// matter. The same for every solver.
#pragma once

#include <Eigen/Core>

#include "problems.hpp"

namespace quadtune::bench {

/// ‖AᵀX + XA - XGX + Q‖ / (‖AᵀX‖ + ‖XA‖ + ‖XGX‖ + ‖Q‖), Frobenius, G = B R⁻¹ Bᵀ.
[[nodiscard]] double care_residual(const Problem& problem, const Eigen::MatrixXd& X);

/// ‖AᵀXA - X - AᵀXB (R + BᵀXB)⁻¹ BᵀXA + Q‖ over the sum of the norms of its four terms, Frobenius.
[[nodiscard]] double dare_residual(const Problem& problem, const Eigen::MatrixXd& X);

/// The larger of ‖Ad - e^(A dt)‖ / ‖e^(A dt)‖ and ‖Bd - ∫ e^(Aτ) dτ B‖ / ‖∫ e^(Aτ) dτ B‖,
/// Frobenius, against a Taylor series in extended precision.
[[nodiscard]] double hold_error(const Problem& problem, double dt, const Eigen::MatrixXd& Ad,
                                const Eigen::MatrixXd& Bd);

}  // namespace quadtune::bench
