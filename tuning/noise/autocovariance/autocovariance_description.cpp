// SPDX-License-Identifier: Apache-2.0
#include "noise/autocovariance/autocovariance_description.hpp"

#include <cmath>

#include "noise/noise_description.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

class Description {
 public:
  Description(const AutocovarianceProblem& problem, const FilterModel& model,
              const AutocovarianceOptions& options, const LeastSquares& solution,
              std::vector<int> free, AutocovarianceFit& fit)
      : problem_(problem),
        model_(model),
        options_(options),
        free_(std::move(free)),
        theta_(solution.theta),
        best_(solution.cost),
        fit_(fit) {}

  void run(const LeastSquares& solution) {
    find_zeros(solution);
    best_ = problem_.cost(theta_);
    fit_.misfit = 2 * problem_.misfit(theta_);
    fit_.information = problem_.information(theta_, free_);
    describe_seen(fit_.information, free_, fit_.parameters, fit_.unseen);
    fit_.theta = theta_;
    for (int i = 0; i < static_cast<int>(fit_.parameters.size()); ++i) describe_one(i);
  }

 private:
  [[nodiscard]] const NoiseParameter& parameter(int i) const {
    return model_.parameters[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] FittedParameter& found(int i) const {
    return fit_.parameters[static_cast<std::size_t>(i)];
  }

  void to_zero(int i) {
    found(i).verdict = ParameterVerdict::at_zero;
    std::erase(free_, i);
  }

  /// Finds variances that ended at zero, or so close that setting them to zero costs nothing.
  void find_zeros(const LeastSquares& solution) {
    for (const int i : std::vector<int>(free_))
      if (solution.at_zero[static_cast<std::size_t>(i)]) to_zero(i);
    for (const int i : std::vector<int>(free_)) {
      if (!parameter(i).logarithmic || problem_.is_vague(i)) continue;
      if (problem_.information(theta_, free_)(i, i) > kSeen) continue;
      VectorXd less = theta_;
      less(i) = kNothing;
      std::vector<int> others = free_;
      std::erase(others, i);
      const LeastSquares without = problem_.solve(less, others);
      if (!(without.cost < best_ + kNoLoss)) continue;
      theta_ = without.theta;
      to_zero(i);
    }
  }

  void describe_one(int i) {
    FittedParameter& p = found(i);
    const bool logarithmic = parameter(i).logarithmic;
    p.value = logarithmic ? std::exp(theta_(i)) : theta_(i);
    if (p.verdict == ParameterVerdict::at_zero) {
      p.value = p.low = 0;
      const double high = edge(i, 2 * options_.confidence - 1, +1);
      p.high = std::exp(high);
      // A value that has a logarithm and no effect.
      fit_.theta(i) = (std::isfinite(high) ? high : start_of(model_)(i)) - 30;
    }
    if (p.verdict != ParameterVerdict::seen) return;
    const double z = deviations(options_.confidence);
    double low = theta_(i) - z * p.standard_error, high = theta_(i) + z * p.standard_error;
    if (options_.profile) {
      low = edge(i, options_.confidence, -1);
      high = edge(i, options_.confidence, +1);
    }
    p.low = logarithmic ? std::exp(low) : low;
    p.high = logarithmic ? std::exp(high) : high;
    // The misfit may not reach this value before the variance is zero.
    if (logarithmic && std::isnan(p.low)) p.low = 0;
  }

  /// The point at which the minimum misfit over all other parameters has grown by half the quantile
  /// of χ² with one degree of freedom.
  double edge(int i, double confidence, int side) {
    const double z = deviations(confidence);
    std::vector<int> others = free_;
    std::erase(others, i);
    const auto loss = [&](double value) {
      VectorXd there = theta_;
      there(i) = value;
      return problem_.solve(there, others).cost - best_;
    };
    const double error = found(i).standard_error, resolution = problem_.resolution(i);
    double centre = theta_(i);
    if (found(i).verdict == ParameterVerdict::at_zero)
      centre = (std::isfinite(resolution) ? std::log(resolution) : start_of(model_)(i)) - 10;
    return edge_of_loss(loss, 0.5 * z * z, centre, side, std::isfinite(error) ? z * error : 2);
  }

  const AutocovarianceProblem& problem_;
  const FilterModel& model_;
  const AutocovarianceOptions& options_;
  std::vector<int> free_;
  VectorXd theta_;
  double best_;
  AutocovarianceFit& fit_;
};

}  // namespace

void describe(const AutocovarianceProblem& problem, const FilterModel& model,
              const AutocovarianceOptions& options, const LeastSquares& solution,
              const std::vector<int>& free, AutocovarianceFit& fit) {
  fit.status =
      solution.converged ? AutocovarianceStatus::solved : AutocovarianceStatus::not_converged;
  if (!solution.converged)
    fit.culprit = "the least squares reached the maximum number of iterations";
  Description(problem, model, options, solution, free, fit).run(solution);
}

}  // namespace quadtune::internal
