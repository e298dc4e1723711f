// SPDX-License-Identifier: Apache-2.0
/// The innovations of a predictor with a constant gain over uniform stretches of logs.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "noise/autocovariance/autocovariance_map.hpp"
#include "noise/autocovariance/uniform_stretches.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::internal {

/// A gain, and the memory of its predictor.
struct SteadyGain {
  bool found = false;
  Eigen::MatrixXd M;  ///< (nx × ny) x⁺ = F (x + M e)
  Eigen::MatrixXd S;  ///< (ny × ny) innovation covariance for which it was designed
  /// Number of samples after which an initial error of the size of the steady-state error is 2 % of
  /// the standard deviation of an innovation.
  Eigen::Index memory = 0;
  std::string culprit;
};

/// Computes the steady-state filter for Q of one step and R; if its memory is too long, or a state
/// has no process noise, one whose poles are closer to 0.
/// @param most  maximum memory in samples
[[nodiscard]] SteadyGain steady_gain(const SampledModel& sampled, const FilterModel& model,
                                     const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                                     Eigen::Index max);

/// Sample autocovariances of the innovations, without the beginning of each stretch.
struct SampleAutocovariances {
  std::vector<Eigen::MatrixXd> of;  ///< lags 0, 1, …: (ny × ny) mean of e[k+j] e[k]ᵀ
  std::vector<double> pairs;        ///< number of pairs in each mean
};

[[nodiscard]] SampleAutocovariances sample_autocovariances(const SampledModel& sampled,
                                                           const FilterModel& model,
                                                           const std::vector<FilterRecord>& records,
                                                           const UniformStretches& uniform,
                                                           const SteadyGain& gain, int lags);

}  // namespace quadtune::internal
