// SPDX-License-Identifier: Apache-2.0
/// A plant of one's own, sampled by a method or taken back to continuous time.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/discretize/discretize.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

struct SamplingOptions {
  DiscretizationMethod method = DiscretizationMethod::zoh;
  double dt = 0;                       ///< sample period [s], > 0
  std::optional<double> prewarp = {};  ///< where tustin is exact [rad/s], in (0, π/dt)
};

/// A plant and how it was found.
struct SampledPlant {
  SamplingOptions by;
  /// Discrete where a continuous plant was sampled, continuous where a discrete one was taken back.
  std::variant<DiscreteLti, ContinuousLti, DiscreteTransferFunction, ContinuousTransferFunction>
      plant;
  std::vector<std::string> warnings = {};  ///< as sample_time_warnings()
};

/// Refuses a prewarp frequency that is out of range, or with another method than tustin.
/// @throws OptionError  naming "prewarp"
void require_prewarp(const SamplingOptions& options);

/// Delays of the channels of a plant.
/// @param delays    [s], ≥ 0; one stands for all channels, none for no delays
/// @param key       of the option, e.g. "input-delay"
/// @param count     of the channels
/// @param channels  "inputs" or "outputs"
/// @return  `count` delays, or none
/// @throws OptionError  naming the key
[[nodiscard]] Eigen::VectorXd channel_delays(const Eigen::VectorXd& delays, const std::string& key,
                                             Eigen::Index count, const std::string& channels);

/// Samples a plant.
/// @throws OptionError   naming "delay": one that is negative
/// @throws InvalidInput  as discretize()
[[nodiscard]] SampledPlant sampled_plant(const ContinuousLti& plant, const ChannelDelays& delays,
                                         const SamplingOptions& options);
[[nodiscard]] SampledPlant sampled_plant(const ContinuousTransferFunction& plant,
                                         const SamplingOptions& options);

/// Takes a plant of period `options.dt` back to continuous time.
/// @param delay  of the transfer function [s], whole samples
/// @throws OptionError   naming "delay": one that is negative, or not a whole number of samples
/// @throws InvalidInput  as to_continuous(), and for other methods than zoh and tustin
[[nodiscard]] SampledPlant continuous_plant(DiscreteLti plant, const SamplingOptions& options);
[[nodiscard]] SampledPlant continuous_plant(DiscreteTransferFunction plant, double delay,
                                            const SamplingOptions& options);

}  // namespace quadtune
