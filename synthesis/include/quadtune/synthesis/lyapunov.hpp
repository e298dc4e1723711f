// SPDX-License-Identifier: Apache-2.0
/// Lyapunov equations, and the norms and Gramians of systems that follow from them.
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

/// The largest gain over all frequencies, and where.
struct PeakGain {
  double gain =
      std::numeric_limits<double>::infinity();  ///< sup σ_max(G); infinite at a pole there
  double w = 0;         ///< [rad/s] where it is reached; infinite for a continuous D alone
  bool stable = false;  ///< all poles are stable, so that this is the H∞ norm
};

/// The L∞ norm, which is the H∞ norm of a stable plant, within `tolerance` relative: crossings of a
/// level are imaginary eigenvalues of a Hamiltonian matrix, so that no peak is missed between
/// frequencies. A discrete plant is mapped to a continuous one of the same norm.
///
/// @param tolerance  relative, in (0, 0.1]
/// @throws InvalidInput  as validate(), or for the tolerance
/// Source: Bruinsma and Steinbuch 1990.
[[nodiscard]] PeakGain peak_gain(const ContinuousLti& plant, double tolerance = 1e-10);
[[nodiscard]] PeakGain peak_gain(const DiscreteLti& plant, double tolerance = 1e-10);

/// √trace(∫ g gᵀ dt) of the impulse response g, the output's variance for white noise of unit
/// density: infinite when the plant is not stable or, continuous, has feed-through.
[[nodiscard]] double h2_norm(const ContinuousLti& plant);
/// √trace(Σ g gᵀ): the output's standard deviation for white noise of unit variance.
[[nodiscard]] double h2_norm(const DiscreteLti& plant);

/// Wc (nx × nx): A Wc + Wc Aᵀ + B Bᵀ = 0, discrete A Wc Aᵀ - Wc + B Bᵀ = 0. xᵀ Wc⁻¹ x is the least
/// input energy that reaches x from rest.
/// @throws InvalidInput  naming the pole that is not stable, for then the integral diverges
[[nodiscard]] Eigen::MatrixXd controllability_gramian(const ContinuousLti& plant);
[[nodiscard]] Eigen::MatrixXd controllability_gramian(const DiscreteLti& plant);

/// Wo (nx × nx): Aᵀ Wo + Wo A + Cᵀ C = 0, discrete Aᵀ Wo A - Wo + Cᵀ C = 0. xᵀ Wo x is the energy
/// of the output that falls from x. Errors as controllability_gramian().
[[nodiscard]] Eigen::MatrixXd observability_gramian(const ContinuousLti& plant);
[[nodiscard]] Eigen::MatrixXd observability_gramian(const DiscreteLti& plant);

}  // namespace quadtune
