// SPDX-License-Identifier: Apache-2.0
/// Lyapunov equations, continuous and discrete (Bartels–Stewart).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

namespace quadtune {

/// How a Lyapunov solve ended.
enum class LyapunovStatus {
  not_run,
  solved,
  singular,  ///< two eigenvalues of A add to 0 (continuous) or multiply to 1 (discrete)
};

/// The solution with its evidence.
struct LyapunovResult {
  LyapunovStatus status = LyapunovStatus::not_run;
  Eigen::MatrixXd X;  ///< (nx × nx) symmetric; all NaN unless solved
  /// ‖residual‖ over the sum of the norms of the terms, Frobenius.
  double residual = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;  ///< the pair of eigenvalues at fault; empty when solved

  [[nodiscard]] bool solved() const { return status == LyapunovStatus::solved; }
};

/// Solves A X + X Aᵀ + Q = 0. X is the Gramian or stationary covariance when A is stable.
///
/// @param A  (nx × nx), nx ≥ 1
/// @param Q  (nx × nx) symmetric; need not be ≥ 0
/// @throws InvalidInput  for shapes, non-finite entries, asymmetry.
/// Source: Bartels and Stewart 1972, by the real Schur form (LAPACK).
[[nodiscard]] LyapunovResult lyapunov_continuous(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& Q);

/// Solves A X Aᵀ - X + Q = 0. Arguments, errors and source as lyapunov_continuous().
[[nodiscard]] LyapunovResult lyapunov_discrete(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                               const Eigen::Ref<const Eigen::MatrixXd>& Q);

}  // namespace quadtune
