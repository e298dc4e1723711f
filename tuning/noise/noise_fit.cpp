// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <random>

#include "noise/constant_measurements.hpp"
#include "noise/noise_description.hpp"
#include "noise/noise_search.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::NoiseObjective;
using internal::search;
using internal::SearchResult;

/// Number of passes of autocovariance least squares for the initial guess.
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
        objective_(likelihood, options.threads, [this](double value) { tell(value); }) {}

  NoiseFit run() {
    try {
      begin();
      if (fit_.status == NoiseFitStatus::not_computed) return fit_;
      search_from_all_starts();
      find_zeros();
      describe();
      fit_.after = likelihood_.evaluate(fit_.theta, LikelihoodOrder::gradient);
    } catch (const Interrupted&) {
      end_early();
    }
    fit_.evaluations = objective_.evaluations();
    return fit_;
  }

 private:
  /// Reports the progress after each evaluation; called by any thread.
  void tell(double value) {
    if (!options_.progress) return;
    const std::lock_guard lock(telling_);
    if (told_ == 0 || value > max_) max_ = value;
    options_.progress(++told_, max_);
  }

  /// Ends with the best point so far, without its uncertainty.
  void end_early() {
    fit_.status = NoiseFitStatus::interrupted;
    fit_.theta = start_of(model_);
    fit_.after = fit_.before;
    if (const NoiseObjective::Best& best = objective_.best(); best.theta.size() > 0) {
      fit_.theta = best.theta;
      fit_.after = best.likelihood;
    }
    fit_.information.resize(0, 0);
    fit_.unseen.clear();
    fit_.parameters = internal::parameters_at(model_, fit_.theta);
  }

  /// Determines the free parameters, and those on which no measurement depends.
  void begin() {
    fit_.theta = start_of(model_);
    fit_.before = likelihood_.evaluate(fit_.theta, LikelihoodOrder::information);
    fit_.parameters = internal::unfitted_parameters(model_);
    // Linearized records contain other measurements; the caller checks the original ones.
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
      throw InvalidInput("fit",
                         fmt::format("the log has {} for {}, expected at least as many",
                                     internal::counted(fit_.before.innovations, "measurement"),
                                     internal::counted(free_.size(), "free parameter")));
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

  /// Result of autocovariance least squares for the parameters that it determines and whose
  /// estimate is not zero.
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
    const std::vector<VectorXd> from = starts();
    std::vector<SearchResult> found(from.size());
    if (from.size() == 1)
      found.front() = search(objective_, from.front(), free_, searching());
    else
      objective_.in_parallel(from.size(), [&](std::size_t s, const NoiseObjective& objective) {
        found[s] = search(objective, from[s], free_, searching());
      });
    SearchResult best;
    for (const SearchResult& end : found)
      if (end.computed && (!best.computed || end.value > best.value)) best = end;
    if (best.computed) {
      fit_.theta = best.theta;
      fit_.information = best.information;
    }
    fit_.starts = static_cast<int>(found.size());
    fit_.agreeing =
        static_cast<int>(std::count_if(found.begin(), found.end(), [&](const SearchResult& end) {
          return end.computed && end.value > best.value - 1e-4;
        }));
    fit_.status = best.converged ? NoiseFitStatus::converged : NoiseFitStatus::not_converged;
  }

  [[nodiscard]] internal::SearchOptions searching() const {
    return {.max_iterations = options_.max_iterations,
            .rough = options_.rough,
            .strides = options_.strides};
  }

  /// Information of θ at fit_.theta.
  [[nodiscard]] MatrixXd curvature() const {
    if (!options_.rough) return objective_.curvature(fit_.theta, free_);
    const auto at = objective_.at(fit_.theta, LikelihoodOrder::information);
    MatrixXd result = MatrixXd::Zero(fit_.theta.size(), fit_.theta.size());
    result(free_, free_) = internal::chosen(at.information, free_);
    return result;
  }

  /// Finds variances whose estimate is zero: their logarithms decrease without bound.
  void find_zeros() {
    const double here = objective_.at(fit_.theta, LikelihoodOrder::value).value;
    fit_.information = curvature();
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
      const SearchResult again = search(objective_, fit_.theta, free_, searching());
      if (again.computed && again.value >= here - internal::kNoLoss) {
        fit_.theta = again.theta;
        if (again.converged) fit_.status = NoiseFitStatus::converged;
      }
      fit_.information = curvature();
    }
    best_ = objective_.at(fit_.theta, LikelihoodOrder::value).value;
  }

  /// Computes the uncertainty, and the combinations of parameters that are not determined.
  void describe() {
    internal::describe_seen(fit_.information, free_, fit_.parameters, fit_.unseen);
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      FittedParameter& p = fit_.parameters[i];
      const double theta = fit_.theta(static_cast<Index>(i));
      p.value = model_.parameters[i].logarithmic ? std::exp(theta) : theta;
      if (p.verdict == ParameterVerdict::at_zero) p.value = p.low = 0;
      if (p.verdict == ParameterVerdict::seen) {
        const double z = internal::deviations(options_.confidence);
        set(p.low, i, theta - z * p.standard_error);
        set(p.high, i, theta + z * p.standard_error);
      }
    }
    if (options_.bounds && !options_.rough) find_edges();
  }

  /// Converts an end of an interval from θ to the reported unit.
  void set(double& end, std::size_t i, double theta) const {
    end = model_.parameters[i].logarithmic ? std::exp(theta) : theta;
  }

  /// Computes the ends of intervals by the profile of the likelihood, each in its own task.
  void find_edges() {
    struct Edge {
      std::size_t parameter;
      int side;
      double confidence;
      double* end;
    };
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      FittedParameter& p = fit_.parameters[i];
      if (p.verdict == ParameterVerdict::at_zero)
        edges.push_back({i, +1, 2 * options_.confidence - 1, &p.high});
      if (p.verdict == ParameterVerdict::seen && options_.profile) {
        edges.push_back({i, -1, options_.confidence, &p.low});
        edges.push_back({i, +1, options_.confidence, &p.high});
      }
    }
    if (edges.empty()) return;
    objective_.in_parallel(edges.size(), [&](std::size_t part, const NoiseObjective& objective) {
      const Edge& of = edges[part];
      set(*of.end, of.parameter,
          edge(objective, static_cast<int>(of.parameter), of.confidence, of.side));
    });
  }

  /// Computes the point at which the profile of the likelihood has fallen by half the quantile of
  /// χ² with one degree of freedom.
  /// @param side  -1 below the optimum, +1 above
  /// @return      NaN if it does not fall that far
  [[nodiscard]] double edge(const NoiseObjective& objective, int i, double confidence,
                            int side) const {
    const double z = internal::deviations(confidence);
    std::vector<int> others = free_;
    std::erase(others, i);
    VectorXd last = fit_.theta;
    const auto loss = [&](double value) {
      // Far from the optimum the other parameters may be at points with no gradient towards a
      // better one: the fit may be the better start.
      VectorXd there = fit_.theta;
      there(i) = last(i) = value;
      const auto of_fit = objective.at(there, LikelihoodOrder::value);
      const auto of_last = objective.at(last, LikelihoodOrder::value);
      if (of_last.computed && !(of_fit.computed && of_fit.value >= of_last.value)) there = last;
      SearchResult found = search(objective, there, others,
                                  {.max_iterations = options_.max_iterations, .rough = true});
      if (found.computed && !found.converged)
        found = search(objective, found.theta, others, {.max_iterations = options_.max_iterations});
      if (!found.computed) return 1e6;
      last = found.theta;
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
  std::mutex telling_;
  int told_ = 0;
  double max_ = 0;
};

}  // namespace

constexpr internal::EnumName<ParameterVerdict> kParameterVerdicts[] = {
    {ParameterVerdict::fixed, "fixed"},         {ParameterVerdict::seen, "determined"},
    {ParameterVerdict::at_zero, "at zero"},     {ParameterVerdict::not_seen, "not determined"},
    {ParameterVerdict::not_known, "not known"}, {ParameterVerdict::combination, "in combination"}};

std::string to_string(ParameterVerdict verdict) {
  return internal::name_in(kParameterVerdicts, verdict);
}

constexpr internal::EnumName<NoiseFitStatus> kNoiseFitStatuses[] = {
    {NoiseFitStatus::not_run, "not run"},
    {NoiseFitStatus::converged, "converged"},
    {NoiseFitStatus::not_computed, "not computed"},
    {NoiseFitStatus::not_converged, "not converged"},
    {NoiseFitStatus::out_of_time, "out of time"},
    {NoiseFitStatus::interrupted, "interrupted"}};

std::string to_string(NoiseFitStatus status) {
  return internal::name_in(kNoiseFitStatuses, status);
}

NoiseFit fit_noise(const InnovationLikelihood& likelihood, const NoiseFitOptions& options) {
  check(options);
  if (!options.interrupted) return Fit(likelihood, options).run();
  InnovationLikelihood asking = likelihood;
  asking.stop_when(options.interrupted);
  return Fit(asking, options).run();
}

}  // namespace quadtune
