// SPDX-License-Identifier: Apache-2.0
/// Poles, zeros, gains and norms of a linear system.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "quadtune/lti.hpp"
#include "quadtune/synthesis/invariant_zeros.hpp"
#include "quadtune/synthesis/lyapunov.hpp"

namespace quadtune {

/// Properties of a linear system.
struct SystemReport {
  double dt = 0;            ///< [s]; 0: continuous
  Eigen::VectorXcd poles;   ///< eigenvalues of A
  InvariantZeros zeros;     ///< invariant zeros
  Eigen::MatrixXd dc_gain;  ///< (ny × nu) response to constant inputs; empty with a pole there
  PeakGain peak;            ///< the H∞ norm if stable
  double h2 = 0;            ///< H2 norm; infinite if unstable, or if continuous with D ≠ 0
};

/// @throws InvalidInput  as validate()
[[nodiscard]] SystemReport system_report(const std::variant<ContinuousLti, DiscreteLti>& system);

}  // namespace quadtune
