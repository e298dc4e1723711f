// SPDX-License-Identifier: Apache-2.0
/// Static output feedback u = -F y of periodic plants: its quadratic cost, the gradient of the
/// cost, and a penalty on small stability margins. Theory: docs/theory.md, "Gains of a given
/// structure".
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "quadtune/synthesis/periodic_loop.hpp"

namespace quadtune {

/// The cost Σ xᵀQx + uᵀRu over all steps, summed over the given initial states.
struct OutputFeedbackProblem {
  PeriodicLti plant;      ///< nx states, nu inputs, ny outputs
  Eigen::MatrixXd Q;      ///< (nx × nx) symmetric, ≥ 0
  Eigen::MatrixXd R;      ///< (nu × nu) symmetric, ≥ 0
  Eigen::MatrixXd start;  ///< (nx × ns) initial states, at step k = 0 of the period
};

/// The cost of a gain, and its gradient.
struct OutputFeedbackCost {
  bool stable = false;  ///< whether all poles of the closed loop lie inside the unit circle
  double cost = std::numeric_limits<double>::infinity();  ///< infinite unless stable
  Eigen::MatrixXd slope;  ///< (nu × ny) ∂cost/∂F; NaN unless stable
};

/// Evaluates u = -F y. The cost and its gradient are computed from two periodic Lyapunov equations.
/// @param problem  plant and weights
/// @param F        (nu × ny)
/// @throws InvalidInput  if shapes disagree or entries are not finite
/// Source: Levine and Athans 1970, for periodic plants as in docs/theory.md.
[[nodiscard]] OutputFeedbackCost output_feedback_cost(const OutputFeedbackProblem& problem,
                                                      const Eigen::MatrixXd& F);

/// Appends integrals of outputs, i[k+1] = i[k] + dt y[k]. The law reads i[k] + now dt y[k].
/// @param plant    periodic, with ny outputs
/// @param outputs  indices of the integrated outputs; their integrals become the last outputs
/// @param now      1: the law advances its integral before it uses it; 0: after; ½: trapezoidal
///                 rule
/// @throws InvalidInput  if an index is out of range
[[nodiscard]] PeriodicLti with_integrals(const PeriodicLti& plant,
                                         const std::vector<Eigen::Index>& outputs, double now);

/// Bounds on a loop with one channel, at given frequencies.
struct MarginBounds {
  double Ms = 2;      ///< maximum of |S|, > 1
  double disk = 0.5;  ///< minimum of the symmetric disk margin, in (0, 2)
};

/// Sum of squares of the violations 1 - Ms |1 + L| and disk |1 - L| / 2 - |1 + L|, where L = F G.
struct MarginPenalty {
  double penalty = 0;        ///< 0 if the margins hold at every frequency
  Eigen::RowVectorXd slope;  ///< (ny) ∂penalty/∂F
};

/// @param response  (ny × nw) G, the mean response of the plant at each frequency
/// @param F         (ny)
/// @param bounds    on Ms and on the disk margin
/// @throws InvalidInput  if the sizes disagree
[[nodiscard]] MarginPenalty margin_penalty(const Eigen::MatrixXcd& response,
                                           const Eigen::RowVectorXd& F, const MarginBounds& bounds);

}  // namespace quadtune
