// SPDX-License-Identifier: Apache-2.0
/// Norms and Gramians of linear systems.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "quadtune/lti.hpp"

namespace quadtune {

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
