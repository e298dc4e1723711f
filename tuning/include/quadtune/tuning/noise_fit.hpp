// SPDX-License-Identifier: Apache-2.0
/// Maximum-likelihood noise covariances of logs, with confidence intervals and the parameters that
/// the logs do not determine.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {

/// Options of the fit.
struct NoiseFitOptions {
  /// Number of starts, ≥ 1: that of the model, and others drawn around it. If there is more than
  /// one, the result of fit_autocovariances() is also a start, if it has one.
  int starts = 3;
  std::uint64_t seed = 1;    ///< of the drawn starts
  double spread = 2;         ///< standard deviation of the logarithms of a drawn start, > 0
  int max_iterations = 200;  ///< maximum number of iterations of each search, > 0
  double confidence = 0.95;  ///< of the intervals, 0 … 1
  /// Whether to compute upper bounds of variances at zero and, with `profile`, intervals from the
  /// profile, each of which requires many searches; if not, bounds are NaN and intervals are those
  /// of the curvature.
  bool bounds = true;
  bool profile = false;  ///< intervals from the profile of the likelihood instead of its curvature
  /// An intermediate fit: to a hundredth of a standard error, with the uncertainty from the Fisher
  /// information and without bounds.
  bool rough = false;
  bool strides = true;      ///< whether to take long steps along flat directions
  std::size_t threads = 1;  ///< 0: one per processor; the result does not depend on it
  /// Called often, by any thread; true ends the fit with the best point so far. May be empty.
  std::function<bool()> interrupted = {};
  /// Called after each evaluation, by one thread at a time, with the number of evaluations and the
  /// maximum of log-likelihood plus log-priors so far. May be empty.
  std::function<void(int evaluations, double best)> progress = {};
};

/// What the logs determine about a parameter.
enum class ParameterVerdict {
  fixed,        ///< it was fixed
  seen,         ///< estimated, with an interval
  at_zero,      ///< the estimate is zero: only an upper bound is known
  not_seen,     ///< no measurement depends on it: the start value is kept
  combination,  ///< only a combination with others is determined; see NoiseFit::unseen
  not_known,    ///< the search ended before this was computed
};

/// In words, e.g. "not determined".
[[nodiscard]] std::string to_string(ParameterVerdict verdict);

/// Estimate of one entry of θ.
struct FittedParameter {
  std::string name;  ///< e.g. "Q.vz"
  std::string unit;  ///< of the variance; empty if unknown
  /// The variance, or the entry of a block
  double value = std::numeric_limits<double>::quiet_NaN();
  /// Standard error of the logarithm of a variance, or of the entry; NaN unless seen.
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  /// Lower end of the interval; 0 if at zero
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();  ///< upper end; NaN if unbounded
  ParameterVerdict verdict = ParameterVerdict::seen;  ///< whether the logs determine the parameter
};

/// How the fit ended.
enum class NoiseFitStatus {
  not_run,
  converged,
  not_computed,   ///< the likelihood cannot be computed at any start; see culprit
  not_converged,  ///< the best search reached the maximum number of iterations
  interrupted,    ///< theta is the best point so far, without uncertainty
  out_of_time,    ///< likewise, after NoiseTuningOptions::seconds
};

/// In words, e.g. "converged".
[[nodiscard]] std::string to_string(NoiseFitStatus status);

/// Estimated covariances with their uncertainty.
struct NoiseFit {
  NoiseFitStatus status = NoiseFitStatus::not_run;  ///< converged, or why not
  Eigen::VectorXd theta;                            ///< (p) the best point
  Likelihood before;                                ///< at the start of the model
  Likelihood after;                                 ///< at theta, with gradient
  /// (p × p) -∂²/∂θ² of the log-likelihood and the log-priors at theta; zero rows for parameters
  /// that are not free.
  Eigen::MatrixXd information;
  std::vector<FittedParameter> parameters;  ///< p, in the order of the model
  /// Descriptions of the directions of θ that the logs do not determine: "only the ratio of Q.vz to
  /// R.sonar is determined".
  std::vector<std::string> unseen;
  int starts = 0;       ///< number of searches
  int agreeing = 0;     ///< number of searches that ended within 1e-4 of the maximum log-likelihood
  int evaluations = 0;  ///< number of evaluations of the likelihood with its gradient
  std::string culprit;  ///< why it is not converged; empty if it is

  /// Whether the best search converged.
  [[nodiscard]] bool converged() const { return status == NoiseFitStatus::converged; }
};

/// Maximizes the likelihood, or the posterior if parameters have priors, by a quasi-Newton search
/// of Ceres in coordinates in which the Fisher information is the identity, followed by Newton
/// steps. Theory: "Covariances from logs".
///
/// @throws InvalidInput  for options out of range, or fewer measurements than parameters.
[[nodiscard]] NoiseFit fit_noise(const InnovationLikelihood& likelihood,
                                 const NoiseFitOptions& options = {});

}  // namespace quadtune
