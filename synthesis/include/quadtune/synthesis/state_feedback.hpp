// SPDX-License-Identifier: Apache-2.0
/// State feedback gains from a linear plant and the weights of a design.
#pragma once

#include <Eigen/Core>

#include "quadtune/design.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// Gains of u = u0 + K (x_sp - x) + K_int ∫(x_sp - x) and their evidence.
struct StateFeedback {
  RiccatiResult riccati;  ///< of the augmented problem; X and K for all nx + ni states
  Eigen::MatrixXd K;      ///< (nu × nx); NaN unless solved
  Eigen::MatrixXd K_int;  ///< (nu × ni); NaN unless solved

  [[nodiscard]] bool solved() const { return riccati.solved(); }  ///< whether there are gains
};

/// Solves the LQR problem of a design on `plant`.
///
/// @param plant    nx states named as in `design.states`, nu inputs
/// @param design   weights, integrals, method and dt
/// @param options  of the Riccati equation, as for lqr(); its state_names are those of all nx + ni
///                 states
/// @throws InvalidInput  for the reasons of lqr() and with_integrals(), and if dt ≤ 0 for a sampled
///                       method.
[[nodiscard]] StateFeedback state_feedback(const ContinuousLti& plant, const LqrDesign& design,
                                           const RiccatiOptions& options = {});

}  // namespace quadtune
