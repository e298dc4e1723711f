// SPDX-License-Identifier: Apache-2.0
/// Lyapunov equations, and the system norms and Gramians that are computed from them.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/lti.hpp"

namespace quadtune {

/// How a Lyapunov solve ended.
enum class LyapunovStatus {
  not_run,
  solved,
  singular,  ///< two eigenvalues of A add to 0 (continuous) or multiply to 1 (discrete)
};

/// The solution with its evidence.
struct LyapunovResult {
  LyapunovStatus status = LyapunovStatus::not_run;  ///< solved, or why there is no solution
  Eigen::MatrixXd X;                                ///< (nx × nx) symmetric; all NaN unless solved
  /// ‖residual‖ over the sum of the norms of the terms, Frobenius.
  double residual = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;  ///< the pair of eigenvalues that prevents a solution; empty when solved

  /// Whether there is a solution.
  [[nodiscard]] bool solved() const { return status == LyapunovStatus::solved; }
};

/// Solves A X + X Aᵀ + Q = 0. X is the Gramian or stationary covariance when A is stable.
///
/// @param A  (nx × nx), nx ≥ 1
/// @param Q  (nx × nx) symmetric; need not be ≥ 0
/// @throws InvalidInput  for wrong shapes, entries that are not finite, or an asymmetric Q.
/// Source: Bartels and Stewart 1972, by the real Schur form (LAPACK).
[[nodiscard]] LyapunovResult lyapunov_continuous(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& Q);

/// Solves A X Aᵀ - X + Q = 0. Arguments, errors and source as lyapunov_continuous().
[[nodiscard]] LyapunovResult lyapunov_discrete(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                               const Eigen::Ref<const Eigen::MatrixXd>& Q);

/// The largest gain over all frequencies, and its frequency.
struct PeakGain {
  double gain =
      std::numeric_limits<double>::infinity();  ///< sup σ_max(G); infinite: a pole on the boundary
  double w = 0;         ///< [rad/s] of the maximum; infinite if D of a continuous plant attains it
  bool stable = false;  ///< whether all poles are stable; `gain` is then the H∞ norm
};

/// Computes the L∞ norm, which is the H∞ norm of a stable plant, to the relative `tolerance`. The
/// frequencies at which the gain crosses a level are imaginary eigenvalues of a Hamiltonian matrix,
/// so that no peak between frequencies is missed. A discrete plant is mapped to a continuous one
/// with the same norm.
///
/// @param plant      any; the gain is infinite if a pole is on the stability boundary
/// @param tolerance  relative, in (0, 0.1]
/// @throws InvalidInput  for the reasons of validate(), or if the tolerance is out of range
/// Source: Bruinsma and Steinbuch 1990.
[[nodiscard]] PeakGain peak_gain(const ContinuousLti& plant, double tolerance = 1e-10);

/// The same for a discrete plant.
[[nodiscard]] PeakGain peak_gain(const DiscreteLti& plant, double tolerance = 1e-10);

/// Computes √trace(∫ g gᵀ dt) of the impulse response g. Its square is the variance of the output
/// for white noise of unit density. Infinite if the plant is unstable or has feed-through.
/// @throws InvalidInput  as validate(), or if a stable pole is too close to the stability boundary
[[nodiscard]] double h2_norm(const ContinuousLti& plant);
/// Computes √trace(Σ g gᵀ), the standard deviation of the output for white noise of unit variance.
/// Infinite if the plant is unstable.
/// @throws InvalidInput  as validate(), or if a stable pole is too close to the stability boundary
[[nodiscard]] double h2_norm(const DiscreteLti& plant);

/// Solves A Wc + Wc Aᵀ + B Bᵀ = 0 (discrete: A Wc Aᵀ - Wc + B Bᵀ = 0) for Wc (nx × nx). xᵀ Wc⁻¹ x
/// is the minimum input energy that drives the plant from 0 to x.
/// @throws InvalidInput  as validate(); if a pole is not stable, because the integral then
///                       diverges, or is too close to the stability boundary; the message names the
///                       pole
[[nodiscard]] Eigen::MatrixXd controllability_gramian(const ContinuousLti& plant);

/// The same for a discrete plant.
[[nodiscard]] Eigen::MatrixXd controllability_gramian(const DiscreteLti& plant);

/// Solves Aᵀ Wo + Wo A + Cᵀ C = 0 (discrete: Aᵀ Wo A - Wo + Cᵀ C = 0) for Wo (nx × nx). xᵀ Wo x is
/// the energy of the output with the initial state x and no input. Errors as
/// controllability_gramian().
[[nodiscard]] Eigen::MatrixXd observability_gramian(const ContinuousLti& plant);

/// The same for a discrete plant.
[[nodiscard]] Eigen::MatrixXd observability_gramian(const DiscreteLti& plant);

}  // namespace quadtune
