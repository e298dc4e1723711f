// SPDX-License-Identifier: Apache-2.0
/// Discretizes a user's plant, or converts it back to continuous time.
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

/// How a plant is sampled.
struct SamplingOptions {
  DiscretizationMethod method = DiscretizationMethod::zoh;  ///< how the plant is sampled
  double dt = 0;                                            ///< sample period [s], > 0
  std::optional<double> prewarp = {};  ///< frequency at which tustin is exact [rad/s], in (0, π/dt)
};

/// A plant and the options with which it was computed.
struct SampledPlant {
  SamplingOptions by;  ///< the options
  /// Discrete if a continuous plant was sampled, continuous if a discrete one was converted.
  std::variant<DiscreteLti, ContinuousLti, DiscreteTransferFunction, ContinuousTransferFunction>
      plant;
  std::vector<std::string> warnings = {};  ///< as sample_time_warnings()
};

/// Rejects a prewarp frequency that is out of range, or with a method other than tustin.
/// @throws OptionError  "prewarp"
void require_prewarp(const SamplingOptions& options);

/// Delays of the channels of a plant.
/// @param delays    [s], ≥ 0; one applies to all channels; empty: no delays
/// @param key       of the option, e.g. "input-delay"
/// @param count     of the channels
/// @param channels  "inputs" or "outputs"
/// @return  `count` delays, or an empty vector
/// @throws OptionError  naming the key
[[nodiscard]] Eigen::VectorXd channel_delays(const Eigen::VectorXd& delays, const std::string& key,
                                             Eigen::Index count, const std::string& channels);

/// Samples a plant.
/// @throws OptionError   "delay", if it is negative
/// @throws InvalidInput  as discretize()
[[nodiscard]] SampledPlant sampled_plant(const ContinuousLti& plant, const ChannelDelays& delays,
                                         const SamplingOptions& options);

/// The same for a transfer function, which has its own delay.
[[nodiscard]] SampledPlant sampled_plant(const ContinuousTransferFunction& plant,
                                         const SamplingOptions& options);

/// Converts a plant with period `options.dt` to continuous time.
/// @param plant    its dt is ignored
/// @param options  method zoh or tustin, and the period
/// @throws InvalidInput  as to_continuous(), and for methods other than zoh and tustin
[[nodiscard]] SampledPlant continuous_plant(DiscreteLti plant, const SamplingOptions& options);

/// The same for a transfer function with a delay.
/// @param plant    its dt and its delay are ignored
/// @param delay    [s], whole samples
/// @param options  method zoh or tustin, and the period
/// @throws OptionError   "delay", if it is negative or not a whole number of samples
/// @throws InvalidInput  likewise
[[nodiscard]] SampledPlant continuous_plant(DiscreteTransferFunction plant, double delay,
                                            const SamplingOptions& options);

}  // namespace quadtune
