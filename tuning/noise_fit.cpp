// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "constant_measurements.hpp"
#include "noise_description.hpp"
#include "noise_search.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::NoiseObjective;
using internal::search;
using internal::SearchResult;

/// Gains that a first guess is worth.
constexpr int kGuessPasses = 3;

void check(const NoiseFitOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    if (!holds)
      throw InvalidInput("fit", fmt::format("{} is {}, expected {}", name, value, expected));
  };
  require(options.starts >= 1, "starts", options.starts, "at least 1");
  require(options.spread > 0 && std::isfinite(options.spread), "spread", options.spread,
          "a positive number");
  require(options.max_iterations >= 1, "max_iterations", options.max_iterations, "at least 1");
  require(options.confidence > 0 && options.confidence < 1, "confidence", options.confidence,
          "more than 0 and less than 1");
}

class Fit {
 public:
  Fit(const InnovationLikelihood& likelihood, const NoiseFitOptions& options)
      : likelihood_(likelihood),
        model_(likelihood.model()),
        options_(options),
        objective_(likelihood) {}

  NoiseFit run() {
    begin();
    if (fit_.status == NoiseFitStatus::not_computed) return fit_;
    search_from_all_starts();
    if (fit_.status == NoiseFitStatus::converged || fit_.status == NoiseFitStatus::not_converged) {
      find_zeros();
      describe();
    }
    fit_.after = likelihood_.evaluate(fit_.theta, LikelihoodOrder::gradient);
    fit_.evaluations = objective_.evaluations();
    return fit_;
  }

 private:
  /// What is free, and what no measurement depends on.
  void begin() {
    fit_.theta = start_of(model_);
    fit_.before = likelihood_.evaluate(fit_.theta, LikelihoodOrder::information);
    fit_.parameters = internal::unfitted_parameters(model_);
    // Of linearized records the measurements are others: who makes them looks at those before.
    const std::vector<FilterRecord>& records = likelihood_.records();
    if (!records.empty() && records.front().linearized.empty())
      fit_.culprit = internal::constant_measurement(model_, records);
    if (!fit_.culprit.empty()) {
      fit_.status = NoiseFitStatus::not_computed;
      return;
    }
    if (!fit_.before.computed()) {
      fit_.status = NoiseFitStatus::not_computed;
      fit_.culprit = fit_.before.culprit.empty() ? "the likelihood is not a number at the start"
                                                 : fit_.before.culprit;
      return;
    }
    for (std::size_t i = 0; i < model_.parameters.size(); ++i) {
      const auto k = static_cast<Index>(i);
      if (model_.parameters[i].fixed) continue;
      if (fit_.before.information(k, k) == 0 && fit_.before.gradient(k) == 0 &&
          !model_.parameters[i].prior)
        internal::name_unmeasured(fit_.parameters[i], fit_.unseen);
      else
        free_.push_back(static_cast<int>(i));
    }
    if (fit_.before.innovations < static_cast<Index>(free_.size()))
      throw InvalidInput("fit", fmt::format("{} measurements came for {} parameters, expected at "
                                            "least as many",
                                            fit_.before.innovations, free_.size()));
  }

  [[nodiscard]] std::vector<VectorXd> starts() const {
    std::vector<VectorXd> starts = {start_of(model_)};
    if (options_.starts == 1) return starts;
    if (const auto guess = autocovariances_guess()) starts.push_back(*guess);
    std::mt19937_64 random(options_.seed);
    std::normal_distribution<double> normal(0, options_.spread);
    for (int s = 1; s < options_.starts; ++s) {
      VectorXd& start = starts.emplace_back(starts.front());
      for (const int i : free_)
        if (model_.parameters[static_cast<std::size_t>(i)].logarithmic) start(i) += normal(random);
    }
    return starts;
  }

  /// What autocovariances find, of those parameters that they see and find more than zero of.
  [[nodiscard]] std::optional<VectorXd> autocovariances_guess() const {
    const AutocovarianceFit found =
        fit_autocovariances(model_, likelihood_.records(), {.passes = kGuessPasses});
    if (!found.solved()) return {};
    VectorXd start = start_of(model_);
    for (const int i : free_)
      if (found.parameters[static_cast<std::size_t>(i)].verdict == ParameterVerdict::seen)
        start(i) = found.theta(i);
    return start;
  }

  void search_from_all_starts() {
    std::vector<double> ends;
    SearchResult best;
    bool stopped = false;
    for (const VectorXd& start : starts()) {
      const SearchResult found = search(objective_, start, free_, options_.max_iterations);
      ++fit_.starts;
      if (found.computed) {
        ends.push_back(found.value);
        if (!best.computed || found.value > best.value) best = found;
      }
      stopped = options_.interrupted && options_.interrupted();
      if (stopped) break;
    }
    if (best.computed) fit_.theta = best.theta;
    fit_.agreeing = static_cast<int>(std::count_if(
        ends.begin(), ends.end(), [&](double value) { return value > best.value - 1e-4; }));
    fit_.status = stopped          ? NoiseFitStatus::interrupted
                  : best.converged ? NoiseFitStatus::converged
                                   : NoiseFitStatus::not_converged;
  }

  /// Variances that the logs want none of: their logarithms run to minus infinity.
  void find_zeros() {
    const double here = objective_.at(fit_.theta, LikelihoodOrder::value).value;
    fit_.information = objective_.curvature(fit_.theta, free_);
    bool moved = false;
    for (const int i : std::vector<int>(free_)) {
      const auto k = static_cast<std::size_t>(i);
      if (!model_.parameters[k].logarithmic || fit_.information(i, i) > internal::kSeen) continue;
      VectorXd less = fit_.theta;
      less(i) -= 20;
      const auto there = objective_.at(less, LikelihoodOrder::value);
      if (!there.computed || there.value < here - internal::kNoLoss) continue;
      fit_.parameters[k].verdict = ParameterVerdict::at_zero;
      std::erase(free_, i);
      fit_.theta(i) = less(i);
      moved = true;
    }
    if (moved) {
      const SearchResult again = search(objective_, fit_.theta, free_, options_.max_iterations);
      if (again.computed && again.value >= here - internal::kNoLoss) {
        fit_.theta = again.theta;
        if (again.converged) fit_.status = NoiseFitStatus::converged;
      }
      fit_.information = objective_.curvature(fit_.theta, free_);
    }
    best_ = objective_.at(fit_.theta, LikelihoodOrder::value).value;
  }

  /// Uncertainty, and what is only seen together with others.
  void describe() {
    internal::describe_seen(fit_.information, free_, fit_.parameters, fit_.unseen);
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      FittedParameter& p = fit_.parameters[i];
      const double theta = fit_.theta(static_cast<Index>(i));
      p.value = model_.parameters[i].logarithmic ? std::exp(theta) : theta;
      if (p.verdict == ParameterVerdict::at_zero) {
        p.value = p.low = 0;
        if (options_.bounds)
          p.high = std::exp(edge(static_cast<int>(i), 2 * options_.confidence - 1, +1));
      }
    }
    for (const int i : free_) {
      FittedParameter& p = fit_.parameters[static_cast<std::size_t>(i)];
      if (p.verdict == ParameterVerdict::seen) interval(i, p);
    }
  }

  void interval(int i, FittedParameter& p) {
    const double z = internal::deviations(options_.confidence);
    const double theta = fit_.theta(i);
    double low = theta - z * p.standard_error, high = theta + z * p.standard_error;
    if (options_.profile && options_.bounds) {
      low = edge(i, options_.confidence, -1);
      high = edge(i, options_.confidence, +1);
    }
    const bool logarithmic = model_.parameters[static_cast<std::size_t>(i)].logarithmic;
    p.low = logarithmic ? std::exp(low) : low;
    p.high = logarithmic ? std::exp(high) : high;
  }

  /// Where the profile of the likelihood has fallen by half the quantile of χ² of one degree.
  /// @param side  -1 below the optimum, +1 above
  /// @return      NaN where it does not fall so far
  double edge(int i, double confidence, int side) {
    const double z = internal::deviations(confidence);
    std::vector<int> others = free_;
    std::erase(others, i);
    VectorXd warm = fit_.theta;
    const auto loss = [&](double value) {
      VectorXd there = warm;
      there(i) = value;
      const SearchResult found = search(objective_, there, others, options_.max_iterations);
      if (!found.computed) return 1e6;
      warm = found.theta;
      return best_ - found.value;
    };
    const double error = fit_.parameters[static_cast<std::size_t>(i)].standard_error;
    return internal::edge_of_loss(loss, 0.5 * z * z, fit_.theta(i), side,
                                  std::isfinite(error) ? z * error : 2);
  }

  const InnovationLikelihood& likelihood_;
  const FilterModel& model_;
  const NoiseFitOptions& options_;
  NoiseObjective objective_;
  std::vector<int> free_;
  double best_ = 0;
  NoiseFit fit_;
};

}  // namespace

std::string to_string(ParameterVerdict verdict) {
  switch (verdict) {
    case ParameterVerdict::fixed:
      return "fixed";
    case ParameterVerdict::seen:
      return "seen";
    case ParameterVerdict::at_zero:
      return "at zero";
    case ParameterVerdict::not_seen:
      return "not seen";
    case ParameterVerdict::combination:
      break;
  }
  return "in combination";
}

std::string to_string(NoiseFitStatus status) {
  switch (status) {
    case NoiseFitStatus::not_run:
      return "not run";
    case NoiseFitStatus::converged:
      return "converged";
    case NoiseFitStatus::not_computed:
      return "not computed";
    case NoiseFitStatus::not_converged:
      return "not converged";
    case NoiseFitStatus::interrupted:
      break;
  }
  return "interrupted";
}

NoiseFit fit_noise(const InnovationLikelihood& likelihood, const NoiseFitOptions& options) {
  check(options);
  return Fit(likelihood, options).run();
}

}  // namespace quadtune
