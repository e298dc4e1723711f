// SPDX-License-Identifier: Apache-2.0
/// The covariances that make logs most likely, how well the logs know them, and which they do not.
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

struct NoiseFitOptions {
  /// The model's own and others drawn about it, ≥ 1; where more than one, also what
  /// fit_autocovariances() finds, where it does.
  int starts = 3;
  std::uint64_t seed = 1;    ///< of the draws
  double spread = 2;         ///< standard deviation of a drawn start's logarithms, > 0
  int max_iterations = 200;  ///< of each search, > 0
  double confidence = 0.95;  ///< of the intervals, 0 … 1
  /// Whether variances at zero get their upper bound and intervals their profile, each of which
  /// costs many searches; else bounds are NaN, and intervals those of the curvature.
  bool bounds = true;
  bool profile = false;  ///< intervals by the profile of the likelihood, not by its curvature
  /// A fit that others follow: to a hundredth of a standard error, its uncertainty by Fisher's
  /// information; no bounds.
  bool rough = false;
  bool strides = true;      ///< whether flat directions are searched far and wide
  std::size_t threads = 1;  ///< 0: one a processor; the result does not depend on it
  /// Asked often, by any thread: true ends the fit with the best so far. May be empty.
  std::function<bool()> interrupted = {};
  /// Called after each evaluation, by one thread at a time: how many there were, and the greatest
  /// log-likelihood with priors so far. May be empty.
  std::function<void(int evaluations, double best)> progress = {};
};

enum class ParameterVerdict {
  fixed,        ///< it was not to be found
  seen,         ///< found, with an interval
  at_zero,      ///< the logs prefer none of it: an upper bound only
  not_seen,     ///< no measurement depends on it: as it was
  combination,  ///< only together with others, see NoiseFit::unseen
  not_known,    ///< the search was ended before that was looked at
};

[[nodiscard]] std::string to_string(ParameterVerdict verdict);

/// One entry of θ, found.
struct FittedParameter {
  std::string name;
  std::string unit;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< the variance, or the entry
  /// Of the logarithm of a variance, or of the entry; NaN unless seen.
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();   ///< of the interval; 0 at zero
  double high = std::numeric_limits<double>::quiet_NaN();  ///< NaN where nothing bounds it
  ParameterVerdict verdict = ParameterVerdict::seen;
};

enum class NoiseFitStatus {
  not_run,
  converged,
  not_computed,   ///< the likelihood has no value at any start: see culprit
  not_converged,  ///< the best search ended at its limit of iterations
  interrupted,    ///< theta is the best so far, without any uncertainty
  out_of_time,    ///< likewise, as NoiseTuningOptions::seconds wants it
};

[[nodiscard]] std::string to_string(NoiseFitStatus status);

struct NoiseFit {
  NoiseFitStatus status = NoiseFitStatus::not_run;
  Eigen::VectorXd theta;  ///< (p) the best found
  Likelihood before;      ///< at the model's start
  Likelihood after;       ///< at theta, with gradient
  /// (p × p) -∂²/∂θ² of the log-likelihood and the priors at theta; zero rows for what is not free.
  Eigen::MatrixXd information;
  std::vector<FittedParameter> parameters;
  /// Directions of θ that the logs do not see, in words: "only the ratio of Q.vz to R.sonar is
  /// seen".
  std::vector<std::string> unseen;
  int starts = 0;       ///< searches made
  int agreeing = 0;     ///< of them, those that ended within 1e-4 of the best log-likelihood
  int evaluations = 0;  ///< of the likelihood with its gradient
  std::string culprit;

  [[nodiscard]] bool converged() const { return status == NoiseFitStatus::converged; }
};

/// Maximum of the likelihood, or of the posterior where parameters have priors, by a quasi-Newton
/// search of Ceres in coordinates in which Fisher's information is the identity, and Newton steps.
/// Theory: "Covariances from logs".
///
/// @throws InvalidInput  for options out of range, or fewer measurements than parameters.
[[nodiscard]] NoiseFit fit_noise(const InnovationLikelihood& likelihood,
                                 const NoiseFitOptions& options = {});

}  // namespace quadtune
