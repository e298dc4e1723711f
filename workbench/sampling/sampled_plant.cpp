// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/sampling/sampled_plant.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/discretize/sample_time.hpp"
#include "quadtune/discretize/to_continuous.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

[[noreturn]] void refuse(const std::string& key, const std::string& message) {
  throw OptionError(key, fmt::format("{} {}", key, message));
}

void require_delay(double delay) {
  if (delay < 0) refuse("delay", fmt::format("is {} s, expected 0 or more", delay));
}

}  // namespace

void require_prewarp(const SamplingOptions& options) {
  if (!options.prewarp) return;
  if (options.method != DiscretizationMethod::tustin)
    refuse("prewarp",
           fmt::format("does not apply to --method {}, expected tustin, because only it distorts "
                       "frequencies in a way that prewarping corrects",
                       to_string(options.method)));
  const double nyquist = std::numbers::pi / options.dt;
  if (!(*options.prewarp > 0 && *options.prewarp < nyquist))
    refuse("prewarp",
           fmt::format("is {:.6g} rad/s, expected more than 0 and less than {:.6g} rad/s "
                       "(pi/dt), the Nyquist frequency",
                       *options.prewarp, nyquist));
}

Eigen::VectorXd channel_delays(const Eigen::VectorXd& delays, const std::string& key,
                               Eigen::Index count, const std::string& channels) {
  for (const double delay : delays)
    if (delay < 0) refuse(key, fmt::format("has {} s, expected 0 or more", delay));
  if (delays.size() == 1) return Eigen::VectorXd::Constant(count, delays[0]);
  if (delays.size() != 0 && delays.size() != count)
    refuse(key, count == 1 ? fmt::format("has {} entries, expected 1", delays.size())
                           : fmt::format("has {} entries, expected {} or one for all {}",
                                         delays.size(), count, channels));
  return delays;
}

SampledPlant sampled_plant(const ContinuousLti& plant, const ChannelDelays& delays,
                           const SamplingOptions& options) {
  DiscreteLti sampled = discretize(plant, options.dt, options.method, {options.prewarp, delays});
  return {options, std::move(sampled), sample_time_warnings(plant, options.dt)};
}

SampledPlant sampled_plant(const ContinuousTransferFunction& plant,
                           const SamplingOptions& options) {
  require_delay(plant.delay);
  DiscreteTransferFunction sampled =
      discretize(plant, options.dt, options.method, {options.prewarp, {}});
  return {options, std::move(sampled), sample_time_warnings(plant, options.dt)};
}

SampledPlant continuous_plant(DiscreteLti plant, const SamplingOptions& options) {
  plant.dt = options.dt;
  return {options, to_continuous(plant, options.method, options.prewarp)};
}

SampledPlant continuous_plant(DiscreteTransferFunction plant, double delay,
                              const SamplingOptions& options) {
  require_delay(delay);
  const double samples = delay / options.dt;
  if (std::abs(samples - std::round(samples)) > 1e-9 || samples > 1e9)
    refuse("delay", fmt::format("is {} s, expected a whole number of samples of {} s because the "
                                "plant is discrete",
                                delay, options.dt));
  plant.dt = options.dt;
  plant.delay = static_cast<int>(std::round(samples));
  return {options, to_continuous(plant, options.method, options.prewarp)};
}

}  // namespace quadtune
