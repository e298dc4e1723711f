// SPDX-License-Identifier: Apache-2.0
/// What a gain tells of the weights that were found for it, and in words what it does not.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/tuning/match_gains.hpp"

namespace quadtune::internal {

/// What is known of each group of equal weights.
struct WeightKnowledge {
  std::vector<std::string> names;  ///< of the groups: "Q(x)", "Q(x) = Q(y)"
  Eigen::VectorXd values;          ///< of the weights, ≥ 0
  Eigen::VectorXd share_of_R;      ///< part of R's geometric mean; sums to 1
  std::vector<bool> fixed;         ///< 0 as it came
  Eigen::MatrixXd by_logarithms;   ///< derivative of the scaled differences
  Eigen::MatrixXd by_weights;      ///< the same by the weight itself
  double tolerance = 0;            ///< on the scaled differences
};

/// Fills low, high and verdict of each group, the geometric mean of R held; the directions that are
/// not seen are told in words.
/// @param groups  one for each of knowledge.names; value is filled, too
void describe_weights(const WeightKnowledge& knowledge, std::vector<MatchedWeight>& groups,
                      std::vector<std::string>& unseen);

}  // namespace quadtune::internal
