// SPDX-License-Identifier: Apache-2.0
/// How well a gain determines the weights that were computed for it, with descriptions of what it
/// does not determine.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/tuning/match_gains.hpp"

namespace quadtune::internal {

/// The inputs of describe_weights() for each group of equal weights.
struct WeightKnowledge {
  std::vector<std::string> names;  ///< of the groups: "Q(x)", "Q(x) = Q(y)"
  Eigen::VectorXd values;          ///< of the weights, ≥ 0
  Eigen::VectorXd share_of_R;      ///< share in the geometric mean of R; sums to 1
  std::vector<bool> fixed;         ///< 0 in the start, and held there
  /// Derivative of the scaled differences with respect to the logarithms
  Eigen::MatrixXd by_logarithms;
  Eigen::MatrixXd by_weights;  ///< the same with respect to the weight itself
  double tolerance = 0;        ///< on the scaled differences
};

/// Computes low, high and verdict of each group with the geometric mean of R held constant, and
/// describes the directions that the gain does not determine.
/// @param groups  one for each of knowledge.names; value is filled, too
void describe_weights(const WeightKnowledge& knowledge, std::vector<MatchedWeight>& groups,
                      std::vector<std::string>& unseen);

}  // namespace quadtune::internal
