// SPDX-License-Identifier: Apache-2.0
/// The innovations of a predictor of constant gain over uniform stretches of logs.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "noise/autocovariance/autocovariance_map.hpp"
#include "noise/autocovariance/uniform_stretches.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::internal {

/// A gain, and how long its predictor remembers where it started.
struct SteadyGain {
  bool found = false;
  Eigen::MatrixXd M;  ///< (nx × ny) x⁺ = F (x + M e)
  Eigen::MatrixXd S;  ///< (ny × ny) covariance that it was chosen for
  /// Samples after which an error of the steady state's size is 2 % of an innovation's deviation.
  Eigen::Index memory = 0;
  std::string culprit;
};

/// The steady filter for Q of a step and R; where it remembers too long, or some state has no noise
/// to drive it, one whose poles are nearer to 0.
/// @param most  samples that it should remember at most
[[nodiscard]] SteadyGain steady_gain(const SampledModel& sampled, const FilterModel& model,
                                     const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                                     Eigen::Index most);

/// Sample autocovariances of the innovations, each stretch's beginning left out.
struct SampleAutocovariances {
  std::vector<Eigen::MatrixXd> of;  ///< lags 0, 1, …: (ny × ny) mean of e[k+j] e[k]ᵀ
  std::vector<double> pairs;        ///< that each mean is of
};

[[nodiscard]] SampleAutocovariances sample_autocovariances(const SampledModel& sampled,
                                                           const FilterModel& model,
                                                           const std::vector<FilterRecord>& records,
                                                           const UniformStretches& uniform,
                                                           const SteadyGain& gain, int lags);

}  // namespace quadtune::internal
