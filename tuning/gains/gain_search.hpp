// SPDX-License-Identifier: Apache-2.0
/// The search for the diagonal weights of a gain, with Ceres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "quadtune/synthesis/diagonal_lqr.hpp"

namespace quadtune::internal {

/// The search problem: weights w = w0 ∘ exp(G z) with one entry of z for each group of equal
/// weights.
struct GainTarget {
  const DiagonalLqr& problem;
  Eigen::MatrixXd K;                     ///< (nu × (nx + ni)) the given gain
  Eigen::MatrixXd scale;                 ///< (nu × (nx + ni)) > 0, unit of each difference
  std::vector<std::vector<int>> groups;  ///< indices of equal weights; each index occurs once
  std::function<bool()> interrupted;
};

/// The gain of some weights compared with the given gain.
struct GainPoint {
  Eigen::VectorXd w;       ///< (p)
  RiccatiResult solution;  ///< of w
  Eigen::VectorXd r;       ///< scaled differences, column by column; empty unless solved

  [[nodiscard]] bool solved() const { return solution.solved(); }
  [[nodiscard]] double cost() const { return r.squaredNorm(); }
};
[[nodiscard]] GainPoint gain_point(const GainTarget& target, const Eigen::VectorXd& w);

/// Derivative of the scaled differences with respect to the logarithm of the weight of each group,
/// and with respect to the weight.
[[nodiscard]] Eigen::MatrixXd by_logarithms(const GainTarget& target, const GainPoint& at);
[[nodiscard]] Eigen::MatrixXd by_weights(const GainTarget& target, const GainPoint& at);

/// Computes the weights for which the given gain is closest to a stationary point of its own cost.
/// For an LQR gain this yields its weights without a search. If there are several, the result is
/// the closest to w0; entries of 0 stay 0.
/// @param w0  (p) equal within each group
[[nodiscard]] Eigen::VectorXd stationary_weights(const GainTarget& target,
                                                 const Eigen::VectorXd& w0);

/// Result of the searches.
struct GainSearch {
  bool stopped = false;    ///< interrupted; nothing else is valid
  GainPoint best;          ///< not solved if no search could start
  std::vector<int> zeros;  ///< groups whose weight is 0 at the best gain
  int evaluations = 0;
  int starts = 0;
  int agreeing = 0;
};

/// Searches from w0, from stationary_weights(), and from random points. Among results of equal cost
/// the first is kept, so that weights that the gain does not determine keep their start.
/// @param w0    (p) equal within each group
/// @param most  maximum number of searches, ≥ 1
[[nodiscard]] GainSearch search_weights(const GainTarget& target, const Eigen::VectorXd& w0,
                                        int max, std::uint64_t seed);

}  // namespace quadtune::internal
