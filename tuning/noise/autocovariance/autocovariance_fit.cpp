// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/autocovariance_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "noise/autocovariance/autocovariance_description.hpp"
#include "noise/autocovariance/autocovariance_map.hpp"
#include "noise/autocovariance/autocovariance_search.hpp"
#include "noise/autocovariance/steady_innovations.hpp"
#include "noise/autocovariance/uniform_stretches.hpp"
#include "noise/constant_measurements.hpp"
#include "noise/noise_description.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::AutocovarianceProblem;
using internal::LeastSquares;
using internal::SampledModel;

/// Minimum number of samples of a stretch.
constexpr Index kMinStretch = 30;
/// Maximum number of outputs for which the covariance of the moments is computed.
constexpr Index kMaxOutputs = 24;
/// Maximum number of moments, and maximum lag in samples of the autocovariances of one output.
constexpr Index kMaxMoments = 800;
constexpr Index kMaxLags = 400;
constexpr Index kMaxGamma = 2000;
/// Convergence of the passes: distance between their results in standard deviations, and change of
/// the logarithms for which the gain is designed.
constexpr double kSame = 0.1;
constexpr double kSameDesign = 0.7;
/// Number of reweightings within a pass.
constexpr int kWeightings = 2;

void check(const AutocovarianceOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    if (!holds)
      throw InvalidInput("autocovariances",
                         fmt::format("{} is {}, expected {}", name, value, expected));
  };
  require(options.lags >= 1, "lags", options.lags, "at least 1");
  require(options.passes >= 1, "passes", options.passes, "at least 1");
  require(options.confidence > 0 && options.confidence < 1, "confidence", options.confidence,
          "more than 0 and less than 1");
}

/// Validates that the gain is stable.
void check_gain(const SampledModel& sampled, const MatrixXd& M) {
  require_shape(M, sampled.F.rows(), sampled.C.rows(), "autocovariances", "M",
                "one row per state, one column per output");
  require_finite(M, "autocovariances", "M");
  const MatrixXd closed = sampled.F - sampled.F * M * sampled.C;
  const double radius = closed.eigenvalues().cwiseAbs().maxCoeff();
  if (!(radius < 1))
    throw InvalidInput(
        "autocovariances",
        fmt::format("F (I - M C) has a pole at radius {:.6g}, expected less than 1", radius));
}

void check_period(const FilterModel& model, double dt) {
  if (!(dt > 0) || !std::isfinite(dt))
    throw InvalidInput("autocovariances",
                       fmt::format("the period is {} s, expected a positive number", dt));
  if (!(model.dt > 0)) return;
  const double steps = std::round(dt / model.dt);
  if (!(steps >= 1) || std::abs(dt - steps * model.dt) > 1e-6 * model.dt)
    throw InvalidInput(
        "autocovariances",
        fmt::format("the period is {} s, expected a multiple of the model's {} s", dt, model.dt));
}

std::vector<Index> all_outputs(const FilterModel& model) {
  std::vector<Index> outputs(static_cast<std::size_t>(model.outputs()));
  std::iota(outputs.begin(), outputs.end(), 0);
  return outputs;
}

/// The autocovariances of the innovations that θ predicts, up to the lag at which they vanish.
std::vector<MatrixXd> gamma_at(const SampledModel& sampled, const MatrixXd& M,
                               const VectorXd& theta) {
  const auto [Q, R] = internal::noise_at(sampled, theta);
  std::vector<MatrixXd> gamma =
      internal::autocovariances(sampled, M, Q, R, static_cast<int>(kMaxGamma / sampled.C.rows()));
  if (gamma.empty()) return gamma;
  const VectorXd size = gamma[0].diagonal().cwiseSqrt().cwiseInverse();
  const auto is_small = [&](const MatrixXd& of) {
    return (size.asDiagonal() * of * size.asDiagonal()).norm() < 1e-5;
  };
  while (gamma.size() > 1 && is_small(gamma.back())) gamma.pop_back();
  return gamma;
}

class Fit {
 public:
  Fit(const FilterModel& model, const AutocovarianceOptions& options)
      : model_(model), options_(options), theta_(start_of(model)), design_(theta_) {
    fit_.parameters = internal::unfitted_parameters(model);
  }

  AutocovarianceFit of_records(const std::vector<FilterRecord>& records) {
    for (const FilterSensor& sensor : model_.sensors)
      if (sensor.student != 0)
        return fail(AutocovarianceStatus::not_computed,
                    fmt::format("errors of {} have Student's distribution; autocovariances require "
                                "normal errors",
                                sensor.name));
    for (const FilterRecord& record : records)
      if (!record.linearized.empty())
        return fail(
            AutocovarianceStatus::no_uniform_stretch,
            "the model changes from instant to instant; autocovariances require a constant model");
    const std::string constant = internal::constant_measurement(model_, records);
    if (!constant.empty()) return fail(AutocovarianceStatus::not_computed, constant);
    const internal::UniformStretches uniform = internal::find_uniform_stretches(model_, records);
    if (uniform.typical < kMinStretch) return no_stretch(uniform);
    const auto ny = static_cast<Index>(uniform.outputs.size());
    if (ny > kMaxOutputs)
      return fail(AutocovarianceStatus::not_computed,
                  fmt::format("{} outputs are measured; autocovariances support at most {}", ny,
                              kMaxOutputs));
    sampled_ = internal::sample_model(model_, uniform.dt, uniform.outputs);
    for (int pass = 0; pass < options_.passes; ++pass) {
      if (options_.interrupted && options_.interrupted()) throw Interrupted();
      const auto [Q, R] = internal::noise_at(sampled_, design_);
      if (!Q.allFinite() || !R.allFinite())
        return fail(AutocovarianceStatus::not_computed,
                    "the covariances exceed the range of a double");
      const internal::SteadyGain gain =
          internal::steady_gain(sampled_, model_, Q, R, uniform.typical / 5);
      if (!gain.found) {
        if (pass > 0) break;
        return fail(AutocovarianceStatus::no_gain, gain.culprit);
      }
      const auto last = std::clamp<Index>(
          gain.memory, std::min<Index>(options_.lags, uniform.typical / 4),
          std::min(uniform.typical / 4, std::max<Index>(options_.lags, kMaxLags / ny)));
      auto sample = internal::sample_autocovariances(sampled_, model_, records, uniform, gain,
                                                     static_cast<int>(last));
      if (sample.pairs[0] < static_cast<double>(kMinStretch)) {
        if (pass > 0) break;
        return fail(AutocovarianceStatus::no_uniform_stretch,
                    fmt::format("the memory of the predictor is at least {} samples, but the "
                                "stretches have about {}",
                                gain.memory, uniform.typical));
      }
      fit_.innovation = {uniform.dt, gain.M, std::move(sample.of), std::move(sample.pairs)};
      const VectorXd before = theta_;
      if (!solve(pass == 0)) return fit_;
      ++fit_.passes;
      const bool settled = pass > 0 && problem_->distance(theta_, before) < kSame;
      if (set_design() < kSameDesign && settled) break;
    }
    internal::describe(*problem_, model_, options_, solution_, free_, fit_);
    return fit_;
  }

  AutocovarianceFit of_given(const InnovationAutocovariances& given) {
    sampled_ = internal::sample_model(model_, given.dt, all_outputs(model_));
    check_gain(sampled_, given.M);
    fit_.innovation = given;
    if (!solve(true)) return fit_;
    fit_.passes = 1;
    internal::describe(*problem_, model_, options_, solution_, free_, fit_);
    return fit_;
  }

 private:
  AutocovarianceFit fail(AutocovarianceStatus status, const std::string& culprit) {
    fit_.status = status;
    fit_.culprit = culprit;
    fit_.theta = start_of(model_);
    return fit_;
  }

  AutocovarianceFit no_stretch(const internal::UniformStretches& uniform) {
    return fail(
        AutocovarianceStatus::no_uniform_stretch,
        fmt::format(
            "autocovariances require at least {} successive samples with a constant sample time "
            "and all measurements in each, which the log does not have: {}",
            kMinStretch, uniform.culprit));
  }

  /// Solves the least squares for the current innovations, with weights from its own results.
  bool solve(bool first) {
    const InnovationAutocovariances& e = fit_.innovation;
    const Index ny = sampled_.C.rows();
    const auto groups = internal::lag_groups(
        static_cast<int>(e.of.size()) - 1,
        static_cast<int>(std::clamp<Index>(kMaxMoments / (ny * ny), 1, options_.lags)));
    for (Index i = 0; i < ny; ++i)
      if (!(e.of[0](i, i) > 0) || !std::isfinite(e.of[0](i, i))) {
        fail(AutocovarianceStatus::not_computed,
             std::isfinite(e.of[0](i, i))
                 ? fmt::format("the innovation of {} has the variance {}", output_name(i),
                               e.of[0](i, i))
                 : fmt::format("the innovation of {} has a variance beyond the range of a double",
                               output_name(i)));
        return false;
      }
    const internal::MomentMap map = internal::moment_map(sampled_, e.M, groups);
    if (map.constant.size() == 0) {
      fail(AutocovarianceStatus::no_gain,
           "the error of the predictor has no steady-state covariance");
      return false;
    }
    if (first) find_free(map);
    const VectorXd moments = internal::moments_of(e.of, groups);
    fit_.samples = e.pairs[0];
    fit_.degrees = static_cast<int>(moments.size()) - static_cast<int>(free_.size());
    for (int round = first ? -1 : 0; round < kWeightings; ++round) {
      const std::vector<MatrixXd> gamma =
          round < 0 ? std::vector<MatrixXd>{e.of[0]} : gamma_at(sampled_, e.M, theta_);
      problem_.emplace(sampled_, model_, map, moments,
                       internal::moment_covariance(gamma, groups, e.pairs));
      solution_ = problem_->solve(design_, free_);
      theta_ = solution_.theta;
      if (!theta_.allFinite() || !std::isfinite(solution_.cost)) {
        fail(AutocovarianceStatus::not_computed, "the least squares exceed the range of a double");
        return false;
      }
    }
    return true;
  }

  /// Determines the free parameters, and those on which no measurement depends.
  void find_free(const internal::MomentMap& map) {
    const int count = static_cast<int>(model_.parameters.size());
    std::vector<bool> used(model_.parameters.size(), false);
    for (std::size_t t = 0; t < sampled_.terms.size(); ++t) {
      const internal::NoiseTerm& term = sampled_.terms[t];
      if (map.of.col(static_cast<Index>(t)).isZero(0)) continue;
      if (term.row < 0) {
        used[static_cast<std::size_t>(term.parameter)] = true;
        continue;
      }
      const auto entry = [&](int i, int q) { return term.parameter + i * (i + 1) / 2 + q; };
      for (const int i : {term.row, term.column})
        for (int q = 0; q <= i; ++q)
          if (q <= std::min(term.row, term.column) || q == i)
            used[static_cast<std::size_t>(entry(i, q))] = true;
    }
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (model_.parameters[k].fixed) continue;
      if (used[k] || model_.parameters[k].prior)
        free_.push_back(i);
      else
        internal::name_unmeasured(fit_.parameters[k], fit_.unseen);
    }
  }

  /// Sets θ for the design of the next gain. A variance that is zero or nearly zero is set to the
  /// largest value that the log does not exclude.
  /// @return  the largest change
  double set_design() {
    const VectorXd before = design_;
    for (const int i : free_) {
      const double resolution = problem_->resolution(i);
      design_(i) = theta_(i);
      if (!model_.parameters[static_cast<std::size_t>(i)].logarithmic) continue;
      const double hidden = std::isfinite(resolution) ? std::log(0.3 * resolution) : before(i) - 5;
      design_(i) = std::max(theta_(i), hidden);
    }
    return design_.size() > 0 ? (design_ - before).cwiseAbs().maxCoeff() : 0;
  }

  [[nodiscard]] std::string output_name(Index i) const {
    Index output = sampled_.outputs[static_cast<std::size_t>(i)];
    for (const FilterSensor& sensor : model_.sensors) {
      if (output < sensor.C.rows())
        return fmt::format("{}: {}", sensor.name,
                           sensor.outputs[static_cast<std::size_t>(output)].name);
      output -= sensor.C.rows();
    }
    return "";
  }

  const FilterModel& model_;
  const AutocovarianceOptions& options_;
  SampledModel sampled_;
  VectorXd theta_;   // the result
  VectorXd design_;  // the θ for which the gain is designed
  std::vector<int> free_;
  std::optional<AutocovarianceProblem> problem_;
  LeastSquares solution_;
  AutocovarianceFit fit_;
};

}  // namespace

constexpr internal::EnumName<AutocovarianceStatus> kAutocovarianceStatuses[] = {
    {AutocovarianceStatus::not_run, "not run"},
    {AutocovarianceStatus::solved, "solved"},
    {AutocovarianceStatus::no_uniform_stretch, "no uniform stretch"},
    {AutocovarianceStatus::no_gain, "no gain"},
    {AutocovarianceStatus::not_computed, "not computed"},
    {AutocovarianceStatus::not_converged, "not converged"}};

std::string to_string(AutocovarianceStatus status) {
  return internal::name_in(kAutocovarianceStatuses, status);
}

AutocovarianceFit fit_autocovariances(const FilterModel& model,
                                      const std::vector<FilterRecord>& records,
                                      const AutocovarianceOptions& options) {
  check(options);
  validate(model, "filter model");
  if (records.empty()) throw InvalidInput("logs", "there are none; expected at least one");
  for (const FilterRecord& record : records) validate(record, model, record.name);
  return Fit(model, options).of_records(records);
}

AutocovarianceFit fit_autocovariances(const FilterModel& model,
                                      const InnovationAutocovariances& given,
                                      const AutocovarianceOptions& options) {
  check(options);
  validate(model, "filter model");
  check_period(model, given.dt);
  const Index ny = model.outputs();
  if (given.of.empty() || given.pairs.size() != given.of.size())
    throw InvalidInput(
        "autocovariances",
        fmt::format("{} and {} were given, expected one of each for every lag, "
                    "beginning with lag 0",
                    internal::counted(given.of.size(), "autocovariance"),
                    internal::counted(given.pairs.size(), "number of pairs", "numbers of pairs")));
  for (std::size_t j = 0; j < given.of.size(); ++j) {
    require_shape(given.of[j], ny, ny, "autocovariances", fmt::format("lag {}", j),
                  "one row and column per output");
    require_finite(given.of[j], "autocovariances", fmt::format("lag {}", j));
    if (!(given.pairs[j] > 0))
      throw InvalidInput(
          "autocovariances",
          fmt::format("lag {} has {} pairs; expected a positive number", j, given.pairs[j]));
  }
  return Fit(model, options).of_given(given);
}

NoiseFit as_noise_fit(const AutocovarianceFit& fit, const InnovationLikelihood& likelihood) {
  NoiseFit result;
  result.theta = fit.theta;
  result.before = likelihood.evaluate(start_of(likelihood.model()));
  result.after = likelihood.evaluate(fit.theta, LikelihoodOrder::gradient);
  result.information = fit.information;
  result.parameters = fit.parameters;
  result.unseen = fit.unseen;
  result.starts = result.agreeing = 1;
  result.evaluations = 2;
  result.culprit = fit.culprit;
  if (fit.solved())
    result.status = NoiseFitStatus::converged;
  else if (fit.status == AutocovarianceStatus::not_converged)
    result.status = NoiseFitStatus::not_converged;
  else
    result.status = NoiseFitStatus::not_computed;
  if (result.status == NoiseFitStatus::converged && !result.after.computed()) {
    result.status = NoiseFitStatus::not_computed;
    result.culprit = result.after.culprit.empty() ? "the likelihood is not a number at the result "
                                                    "of the autocovariances"
                                                  : result.after.culprit;
  }
  return result;
}

std::vector<MatrixXd> innovation_autocovariances(const FilterModel& model, double dt,
                                                 const Eigen::Ref<const MatrixXd>& M,
                                                 const Eigen::Ref<const VectorXd>& theta,
                                                 int lags) {
  validate(model, "filter model");
  check_period(model, dt);
  require_shape(theta, static_cast<Index>(model.parameters.size()), 1, "autocovariances", "theta",
                "one entry per parameter");
  require_finite(theta, "autocovariances", "theta");
  if (lags < 0)
    throw InvalidInput("autocovariances", fmt::format("lags is {}, expected 0 or more", lags));
  const SampledModel sampled = internal::sample_model(model, dt, all_outputs(model));
  check_gain(sampled, M);
  const auto [Q, R] = internal::noise_at(sampled, theta);
  return internal::autocovariances(sampled, M, Q, R, lags);
}

}  // namespace quadtune
