// SPDX-License-Identifier: Apache-2.0
/// The search for the diagonal weights of a gain, with Ceres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "quadtune/synthesis/diagonal_lqr.hpp"

namespace quadtune::internal {

/// What is looked for: weights w = w0 ∘ exp(G z), one entry of z for each group of weights that are
/// equal.
struct GainTarget {
  const DiagonalLqr& problem;
  Eigen::MatrixXd K;      ///< (nu × (nx + ni)) the given gain
  Eigen::MatrixXd scale;  ///< (nu × (nx + ni)) > 0: what a difference is relative to
  std::vector<std::vector<int>> groups;  ///< indices of weights that are equal, each once
  std::function<bool()> interrupted;
};

/// The gain of some weights beside the given one.
struct GainPoint {
  Eigen::VectorXd w;       ///< (p)
  RiccatiResult solution;  ///< of w
  Eigen::VectorXd r;       ///< scaled differences, column by column; empty unless solved

  [[nodiscard]] bool solved() const { return solution.solved(); }
  [[nodiscard]] double cost() const { return r.squaredNorm(); }
};
[[nodiscard]] GainPoint gain_point(const GainTarget& target, const Eigen::VectorXd& w);

/// Derivative of the scaled differences by the logarithm of each group's weight, and by the weight.
[[nodiscard]] Eigen::MatrixXd by_logarithms(const GainTarget& target, const GainPoint& at);
[[nodiscard]] Eigen::MatrixXd by_weights(const GainTarget& target, const GainPoint& at);

/// Weights that make the given gain's own cost stationary, as nearly as can be: of an LQR gain
/// those that it is of, without a search. Among several the nearest to w0, entries of 0 as there.
/// @param w0  (p) equal within each group
[[nodiscard]] Eigen::VectorXd stationary_weights(const GainTarget& target,
                                                 const Eigen::VectorXd& w0);

/// Where the searches ended.
struct GainSearch {
  bool stopped = false;    ///< interrupted; nothing else is valid
  GainPoint best;          ///< not solved where no search could begin
  std::vector<int> zeros;  ///< groups whose weight the best gain wants none of
  int evaluations = 0;
  int starts = 0;
  int agreeing = 0;
};

/// Searches from w0; from stationary_weights(); from random ones.
/// Of ends of equal cost the first counts, so that what the gain does not see stays as it came.
/// @param w0    (p) equal within each group
/// @param most  searches at most, ≥ 1
[[nodiscard]] GainSearch search_weights(const GainTarget& target, const Eigen::VectorXd& w0,
                                        int most, std::uint64_t seed);

}  // namespace quadtune::internal
