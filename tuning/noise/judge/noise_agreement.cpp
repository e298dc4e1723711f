// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/tails.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"

namespace quadtune {
namespace {

/// Compares the two estimates of a parameter.
ParameterAgreement agreement_of(const FittedParameter& mine, const FittedParameter& other,
                                bool logarithmic) {
  ParameterAgreement result{other};
  if (!logarithmic) return result;
  const auto seen = [](const FittedParameter& p) {
    return p.verdict == ParameterVerdict::seen && p.value > 0;
  };
  const auto bounded = [](const FittedParameter& p) {
    return p.verdict == ParameterVerdict::at_zero && p.high > 0 && std::isfinite(p.high);
  };
  if (seen(mine) && seen(other)) {
    const double apart = std::abs(std::log(mine.value / other.value));
    result.factor = std::exp(apart);
    result.deviations = apart / std::hypot(mine.standard_error, other.standard_error);
  } else if ((seen(mine) && bounded(other)) || (bounded(mine) && seen(other))) {
    const FittedParameter& found = seen(mine) ? mine : other;
    const double apart = std::max(std::log(found.value / (seen(mine) ? other : mine).high), 0.0);
    result.factor = std::exp(apart);
    result.deviations = apart / found.standard_error;
  }
  return result;
}

std::string estimate(const FittedParameter& p, NoiseMethod method) {
  const char* by = method == NoiseMethod::likelihood ? "maximum likelihood" : "the autocovariances";
  if (p.verdict == ParameterVerdict::at_zero)
    return fmt::format("zero, at most {:.4g}, by {}", p.high, by);
  return fmt::format("{:.4g} ({:.4g} to {:.4g}) by {}", p.value, p.low, p.high, by);
}

NoiseMethod other_than(NoiseMethod method) {
  return method == NoiseMethod::likelihood ? NoiseMethod::autocovariances : NoiseMethod::likelihood;
}

/// Fits by the other method, starting near its expected result.
NoiseFit fit_otherwise(const NoiseFit& fit, NoiseMethod method,
                       const InnovationLikelihood& likelihood, const AgreementOptions& options) {
  if (method == NoiseMethod::likelihood)
    return as_noise_fit(fit_autocovariances(likelihood.model(), likelihood.records(),
                                            {.interrupted = options.interrupted}),
                        likelihood);
  FilterModel from = likelihood.model();
  for (std::size_t i = 0; i < from.parameters.size(); ++i)
    if (fit.parameters[i].verdict == ParameterVerdict::seen)
      from.parameters[i].start = from.parameters[i].logarithmic
                                     ? std::exp(fit.theta(static_cast<Eigen::Index>(i)))
                                     : fit.theta(static_cast<Eigen::Index>(i));
  return fit_noise(InnovationLikelihood(from, likelihood.records()),
                   {.starts = 1, .threads = options.threads, .interrupted = options.interrupted});
}

}  // namespace

std::string to_string(NoiseMethod method) {
  return method == NoiseMethod::likelihood ? "ml" : "als";
}

NoiseAgreement compare_methods(const NoiseFit& fit, NoiseMethod method,
                               const InnovationLikelihood& likelihood,
                               const AgreementOptions& options) {
  NoiseAgreement result;
  result.other = other_than(method);
  NoiseFit other;
  try {
    other = fit_otherwise(fit, method, likelihood, options);
  } catch (const Interrupted&) {
    other.status = NoiseFitStatus::interrupted;
  }
  if (!other.converged()) {
    result.not_compared =
        other.culprit.empty() ? "its fit is " + to_string(other.status) : other.culprit;
    return result;
  }
  result.theta = other.theta;
  double compared = 0;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const bool logarithmic = likelihood.model().parameters[i].logarithmic;
    result.parameters.push_back(agreement_of(fit.parameters[i], other.parameters[i], logarithmic));
    if (std::isfinite(result.parameters.back().deviations)) ++compared;
  }
  if (compared == 0) {
    result.not_compared = "no parameter is estimated by both methods";
    return result;
  }
  const double max = internal::normal_exceeded(0.5 * options.significance / compared);
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    ParameterAgreement& p = result.parameters[i];
    p.disagrees = p.deviations > max && p.factor > options.max_factor;
    if (!p.disagrees) continue;
    result.disagreements.push_back(fmt::format(
        "{} is {}, and {}: a factor of {:.3g}, {:.3g} standard deviations, although both would be "
        "right if the model were; its intervals are not valid",
        p.other.name, estimate(fit.parameters[i], method), estimate(p.other, result.other),
        p.factor, p.deviations));
  }
  return result;
}

}  // namespace quadtune
