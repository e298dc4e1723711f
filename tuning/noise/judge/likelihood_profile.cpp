// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/likelihood_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "noise/noise_search.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using internal::NoiseObjective;

/// Half width of the profile of a parameter without a standard error.
constexpr double kUnknown = 3;

void check(const NoiseFit& fit, int parameter, const LikelihoodProfileOptions& options) {
  const auto count = static_cast<int>(fit.parameters.size());
  if (parameter < 0 || parameter >= count || fit.theta.size() != count ||
      fit.parameters[static_cast<std::size_t>(parameter)].verdict == ParameterVerdict::fixed ||
      fit.parameters[static_cast<std::size_t>(parameter)].verdict == ParameterVerdict::not_known)
    throw InvalidInput(
        "profile",
        fmt::format("parameter {} of {} was not fitted; expected a fitted one", parameter, count));
  if (options.points < 3 || !(options.deviations > 0) || options.max_iterations < 1)
    throw InvalidInput("profile",
                       fmt::format("{} points over {} deviations with {} iterations; expected 3 or "
                                   "more, a positive number, and 1 or more",
                                   options.points, options.deviations, options.max_iterations));
}

/// Minimum and maximum of the parameter.
std::pair<double, double> span(const NoiseFit& fit, int parameter, double deviations) {
  const FittedParameter& p = fit.parameters[static_cast<std::size_t>(parameter)];
  const double centre = fit.theta(parameter);
  if (p.verdict == ParameterVerdict::at_zero) {
    const double top = std::isfinite(p.high) && p.high > 0 ? std::log(p.high) : centre;
    return {top - 2 * kUnknown, top + 1};
  }
  const double half = std::isfinite(p.standard_error) ? deviations * p.standard_error : kUnknown;
  return {centre - half, centre + half};
}

}  // namespace

LikelihoodProfile likelihood_profile(const InnovationLikelihood& likelihood, const NoiseFit& fit,
                                     int parameter, const LikelihoodProfileOptions& options) {
  check(fit, parameter, options);
  const NoiseObjective objective(likelihood);
  const double top = objective.at(fit.theta, LikelihoodOrder::value).value;
  std::vector<int> others;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const ParameterVerdict verdict = fit.parameters[i].verdict;
    const bool free = verdict == ParameterVerdict::seen || verdict == ParameterVerdict::combination;
    if (free && static_cast<int>(i) != parameter) others.push_back(static_cast<int>(i));
  }
  const auto [low, high] = span(fit, parameter, options.deviations);
  LikelihoodProfile profile;
  profile.theta = VectorXd::LinSpaced(options.points, low, high);
  profile.value.resize(options.points);
  // Proceed outwards from the fit, since each point starts at the result of its neighbour.
  const double* begin = profile.theta.data();
  const Index middle = std::clamp<Index>(
      std::lower_bound(begin, begin + options.points, fit.theta(parameter)) - begin, 0,
      options.points - 1);
  const auto walk = [&](Index from, Index to, Index step) {
    VectorXd warm = fit.theta;
    for (Index k = from; k != to; k += step) {
      warm(parameter) = profile.theta(k);
      const internal::SearchResult found = internal::search(
          objective, warm, others, {.max_iterations = options.max_iterations, .rough = true});
      profile.value(k) = found.computed ? found.value - top : std::nan("");
      if (found.computed) warm = found.theta;
    }
  };
  walk(middle, options.points, 1);
  walk(middle - 1, -1, -1);
  return profile;
}

}  // namespace quadtune
