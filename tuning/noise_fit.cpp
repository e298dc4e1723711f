// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <random>

#include "noise_search.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::NoiseObjective;
using internal::search;
using internal::SearchResult;

/// A direction with less information is not seen: a standard deviation of more than 5 e-folds.
constexpr double kSeen = 0.04;
/// Loss of log-likelihood that no data tell from none.
constexpr double kNoLoss = 0.05;

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
    fit_.parameters.resize(model_.parameters.size());
    for (std::size_t i = 0; i < model_.parameters.size(); ++i) {
      fit_.parameters[i].name = model_.parameters[i].name;
      fit_.parameters[i].unit = model_.parameters[i].unit;
      if (model_.parameters[i].fixed) fit_.parameters[i].verdict = ParameterVerdict::fixed;
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
          !model_.parameters[i].prior) {
        fit_.parameters[i].verdict = ParameterVerdict::not_seen;
        fit_.unseen.push_back(
            fmt::format("{}: no measurement depends on it", model_.parameters[i].name));
      } else {
        free_.push_back(static_cast<int>(i));
      }
    }
    if (fit_.before.innovations < static_cast<Index>(free_.size()))
      throw InvalidInput("fit", fmt::format("{} measurements came for {} parameters, expected at "
                                            "least as many",
                                            fit_.before.innovations, free_.size()));
  }

  void search_from_all_starts() {
    std::mt19937_64 random(options_.seed);
    std::normal_distribution<double> normal(0, options_.spread);
    std::vector<double> ends;
    SearchResult best;
    bool stopped = false;
    for (int s = 0; s < options_.starts && !stopped; ++s) {
      VectorXd start = start_of(model_);
      for (const int i : free_)
        if (s > 0 && model_.parameters[static_cast<std::size_t>(i)].logarithmic)
          start(i) += normal(random);
      const SearchResult found = search(objective_, start, free_, options_.max_iterations);
      ++fit_.starts;
      if (found.computed) {
        ends.push_back(found.value);
        if (!best.computed || found.value > best.value) best = found;
      }
      stopped = options_.interrupted && options_.interrupted();
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
    const MatrixXd curvature = objective_.curvature(fit_.theta, free_);
    for (const int i : std::vector<int>(free_)) {
      const auto k = static_cast<std::size_t>(i);
      if (!model_.parameters[k].logarithmic || curvature(i, i) > kSeen) continue;
      VectorXd less = fit_.theta;
      less(i) -= 20;
      const auto there = objective_.at(less, LikelihoodOrder::value);
      if (!there.computed || there.value < here - kNoLoss) continue;
      fit_.parameters[k].verdict = ParameterVerdict::at_zero;
      std::erase(free_, i);
      fit_.theta(i) = less(i);
    }
    if (std::any_of(fit_.parameters.begin(), fit_.parameters.end(),
                    [](const auto& p) { return p.verdict == ParameterVerdict::at_zero; })) {
      const SearchResult again = search(objective_, fit_.theta, free_, options_.max_iterations);
      if (again.computed && again.value >= here - kNoLoss) {
        fit_.theta = again.theta;
        if (again.converged) fit_.status = NoiseFitStatus::converged;
      }
    }
    best_ = objective_.at(fit_.theta, LikelihoodOrder::value).value;
  }

  /// Uncertainty, and what is only seen together with others.
  void describe() {
    fit_.information = objective_.curvature(fit_.theta, free_);
    const auto n = static_cast<Index>(free_.size());
    MatrixXd information(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        information(i, j) = fit_.information(free_[static_cast<std::size_t>(i)],
                                             free_[static_cast<std::size_t>(j)]);
    MatrixXd covariance = MatrixXd::Zero(n, n);
    if (n > 0) {
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
      for (Index q = 0; q < n; ++q) {
        const VectorXd direction = eigen.eigenvectors().col(q);
        if (eigen.eigenvalues()(q) > kSeen)
          covariance += direction * direction.transpose() / eigen.eigenvalues()(q);
        else
          name_unseen(direction);
      }
    }
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      FittedParameter& p = fit_.parameters[i];
      const double theta = fit_.theta(static_cast<Index>(i));
      p.value = model_.parameters[i].logarithmic ? std::exp(theta) : theta;
      if (p.verdict == ParameterVerdict::at_zero) {
        p.value = p.low = 0;
        p.high = std::exp(edge(static_cast<int>(i), 2 * options_.confidence - 1, +1));
      }
    }
    for (Index q = 0; q < n; ++q) {
      const int i = free_[static_cast<std::size_t>(q)];
      FittedParameter& p = fit_.parameters[static_cast<std::size_t>(i)];
      if (p.verdict != ParameterVerdict::seen) continue;
      p.standard_error = std::sqrt(covariance(q, q));
      interval(i, p);
    }
  }

  void interval(int i, FittedParameter& p) {
    const boost::math::normal normal;
    const double z = boost::math::quantile(normal, 0.5 + 0.5 * options_.confidence);
    const double theta = fit_.theta(i);
    double low = theta - z * p.standard_error, high = theta + z * p.standard_error;
    if (options_.profile) {
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
    const boost::math::normal normal;
    const double z = boost::math::quantile(normal, 0.5 + 0.5 * confidence);
    std::vector<int> others = free_;
    std::erase(others, i);
    VectorXd warm = fit_.theta;
    const auto fall = [&](double value) {
      VectorXd there = warm;
      there(i) = value;
      const SearchResult found = search(objective_, there, others, options_.max_iterations);
      if (!found.computed) return 1e6;
      warm = found.theta;
      return best_ - found.value - 0.5 * z * z;
    };
    double inside = fit_.theta(i), outside = inside, before = -0.5 * z * z, after = before;
    double step = std::isfinite(error_of(i)) ? z * error_of(i) : 2;
    for (int tries = 0; tries < 40; ++tries) {
      outside = inside + side * step;
      after = fall(outside);
      if (after > 0) break;
      inside = outside;
      before = after;
      step *= 1.5;
    }
    if (!(after > 0)) return std::numeric_limits<double>::quiet_NaN();
    warm = fit_.theta;
    std::uintmax_t most = 60;
    const bool up = inside < outside;
    const auto bracket = boost::math::tools::toms748_solve(
        fall, up ? inside : outside, up ? outside : inside, up ? before : after,
        up ? after : before, [](double a, double b) { return std::abs(a - b) < 1e-6; }, most);
    return 0.5 * (bracket.first + bracket.second);
  }

  [[nodiscard]] double error_of(int i) const {
    return fit_.parameters[static_cast<std::size_t>(i)].standard_error;
  }

  /// A direction of the free parameters along which the likelihood is flat, in words.
  void name_unseen(const VectorXd& direction) {
    std::vector<Index> main;
    const double most = direction.cwiseAbs().maxCoeff();
    for (Index q = 0; q < direction.size(); ++q)
      if (std::abs(direction(q)) > 0.3 * most) main.push_back(q);
    const auto name = [&](Index q) {
      return fit_.parameters[static_cast<std::size_t>(free_[static_cast<std::size_t>(q)])].name;
    };
    for (const Index q : main)
      fit_.parameters[static_cast<std::size_t>(free_[static_cast<std::size_t>(q)])].verdict =
          main.size() == 1 ? ParameterVerdict::not_seen : ParameterVerdict::combination;
    if (main.size() == 1) {
      fit_.unseen.push_back(fmt::format("{}: the measurements do not tell it", name(main[0])));
      return;
    }
    const double a = direction(main[0]), b = direction(main[1]);
    if (main.size() == 2 && std::abs(std::abs(a) - std::abs(b)) < 0.2 * most) {
      fit_.unseen.push_back(fmt::format("only the {} of {} {} {} is seen",
                                        a * b > 0 ? "ratio" : "product", name(main[0]),
                                        a * b > 0 ? "to" : "and", name(main[1])));
      return;
    }
    std::vector<std::string> words;
    for (const Index q : main)
      words.push_back(fmt::format("{:+.2f} log {}", direction(q), name(q)));
    fit_.unseen.push_back(fmt::format("not seen: {}", fmt::join(words, " ")));
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
