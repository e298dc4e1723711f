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
  std::string name;               ///< for messages, e.g. "at 3 m"
  OutputFeedbackProblem problem;  ///< plant and weights
  double weight = 1;              ///< weight of its cost in the sum, ≥ 0
  Eigen::MatrixXcd response;      ///< as in margin_penalty(); empty: its margins are not bounded
  MarginBounds bounds;            ///< on its margins
  /// Outputs that an inner loop feeds back, such as the tilt and its rate in a cascade; empty:
  /// there is no inner loop. The outer loop, opened at the command of the inner loop, is bounded by
  /// outer_Ms.
  std::vector<Eigen::Index> inner = {};
  double outer_Ms = std::numeric_limits<double>::infinity();  ///< max |S| of the outer loop, > 1
};

/// A bound |factor Π F_j^power_j| ≤ 1 on the gains themselves; j runs over the columns of F.
struct GainProductBound {
  double factor = 1;        ///< > 0
  std::vector<int> powers;  ///< (ny)
};

/// Options of fixed_gains().
struct FixedGainsOptions {
  int max_iterations = 200;  ///< of each search, ≥ 1
  /// On the gradient with respect to relative changes of the gains
  double gradient_tolerance = 1e-8;
  std::vector<GainProductBound> products = {};  ///< only for a law with one input
};

/// How the search ended.
enum class FixedGainsStatus {
  not_run,
  solved,           ///< a minimum within the bounds
  unstable_start,   ///< a member is unstable with the starting gains
  bounds_violated,  ///< the search ended outside the bounds of a member
  no_convergence,   ///< the maximum number of iterations was reached
};
/// "solved", "unstable start", …
[[nodiscard]] std::string to_string(FixedGainsStatus status);

/// Gains with their evidence.
struct FixedGainsResult {
  /// Solved, or why the search ended otherwise.
  FixedGainsStatus status = FixedGainsStatus::not_run;
  Eigen::MatrixXd F;  ///< (nu × ny) gains; every member is stable with them unless unstable_start
  double cost = std::numeric_limits<double>::quiet_NaN();        ///< weighted sum
  double start_cost = std::numeric_limits<double>::quiet_NaN();  ///< with the starting gains
  double slope = std::numeric_limits<double>::quiet_NaN();  ///< max |∂ log cost/∂ log F| at the end
  /// Largest relative bound violation of all members; ≤ 0 if all bounds hold
  double violation = 0;
  int evaluations = 0;  ///< number of evaluations of the cost
  std::string culprit;  ///< the member that caused the failure; empty if solved

  /// Whether F is a minimum within the bounds.
  [[nodiscard]] bool solved() const { return status == FixedGainsStatus::solved; }
};

/// Minimizes Σ weight · cost over the entries of F that are not 0 in `start`; the others stay 0.
/// The search takes quasi-Newton steps (BFGS) and shortens a step that makes a member unstable.
/// Violated bounds are penalized with increasing weight.
/// @param members  at least one
/// @param start    (nu × ny) gains with which every member is stable
/// @param options  limits of the search
/// @throws InvalidInput  as output_feedback_cost(); if there is no member or no free entry, for
///                       bounds out of range, or for bounds with several inputs
[[nodiscard]] FixedGainsResult fixed_gains(const std::vector<FixedGainsMember>& members,
                                           const Eigen::MatrixXd& start,
                                           const FixedGainsOptions& options = {});

}  // namespace quadtune
