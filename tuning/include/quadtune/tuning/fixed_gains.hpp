// SPDX-License-Identifier: Apache-2.0
/// Gains of a given structure that minimize a quadratic cost over a set of plants, with bounds on
/// the margins. Theory: docs/theory.md, "Gains of a given structure".
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/output_feedback.hpp"

namespace quadtune {

/// One plant of the set.
struct FixedGainsMember {
  std::string name;  ///< for messages, e.g. "at 3 m"
  OutputFeedbackProblem problem;
  double weight = 1;          ///< of its cost in the sum, ≥ 0
  Eigen::MatrixXcd response;  ///< as margin_penalty(); empty: its margins are not bounded
  MarginBounds bounds;
  /// Outputs that an inner loop feeds back, such as the tilt and its rate of a cascade; none: no
  /// inner loop. The outer loop, cut where it commands the inner one, is bounded by outer_Ms.
  std::vector<Eigen::Index> inner = {};
  double outer_Ms = std::numeric_limits<double>::infinity();  ///< max |S| of the outer loop, > 1
};

/// A bound |factor Π F_j^power_j| ≤ 1 on the gains themselves, j over the columns of F.
struct GainProductBound {
  double factor = 1;        ///< > 0
  std::vector<int> powers;  ///< (ny)
};

struct FixedGainsOptions {
  int max_iterations = 200;                     ///< of each search, ≥ 1
  double gradient_tolerance = 1e-8;             ///< on the slope by relative changes of the gains
  std::vector<GainProductBound> products = {};  ///< of a law with one input
};

enum class FixedGainsStatus {
  not_run,
  solved,           ///< a minimum within the bounds
  unstable_start,   ///< a member is unstable with the starting gains
  bounds_violated,  ///< the search ended outside the bounds of a member
  no_convergence,   ///< the iterations ran out
};
/// "solved", "unstable start", …
[[nodiscard]] std::string to_string(FixedGainsStatus status);

struct FixedGainsResult {
  FixedGainsStatus status = FixedGainsStatus::not_run;
  Eigen::MatrixXd F;  ///< (nu × ny) gains; every member is stable with them unless unstable_start
  double cost = std::numeric_limits<double>::quiet_NaN();        ///< weighted sum
  double start_cost = std::numeric_limits<double>::quiet_NaN();  ///< with the starting gains
  double slope = std::numeric_limits<double>::quiet_NaN();  ///< max |∂ log cost/∂ log F| at the end
  double violation = 0;  ///< largest of all members' bounds, relative; ≤ 0 within them
  int evaluations = 0;
  std::string culprit;  ///< the member at fault; empty when solved

  [[nodiscard]] bool solved() const { return status == FixedGainsStatus::solved; }
};

/// Minimizes Σ weight · cost over the entries of F that are not 0 in `start`; the others stay 0.
/// Quasi-Newton steps (BFGS); a step that makes a member unstable is shortened. Violated bounds are
/// penalized with growing weight.
/// @param start  (nu × ny) gains with which every member is stable
/// @throws InvalidInput  as output_feedback_cost(); for no member, no free entry, bounds out of
///                       range, or bounds with several inputs
[[nodiscard]] FixedGainsResult fixed_gains(const std::vector<FixedGainsMember>& members,
                                           const Eigen::MatrixXd& start,
                                           const FixedGainsOptions& options = {});

}  // namespace quadtune
