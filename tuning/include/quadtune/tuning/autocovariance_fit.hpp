// SPDX-License-Identifier: Apache-2.0
/// Noise covariances from how the errors of a predictor with a constant gain hang together in time:
/// autocovariance least squares.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {

struct AutocovarianceOptions {
  /// Groups of lags besides lag 0, ≥ 1: single lags where so many reach as far as the predictor
  /// remembers, else later ones averaged in groups that widen.
  int lags = 15;
  int passes = 10;  ///< at most so often is the gain chosen anew from what was found, ≥ 1
  double confidence = 0.95;  ///< of the intervals, 0 … 1
  bool profile = false;      ///< intervals by the profile of the misfit, not by its curvature
  std::function<bool()> interrupted = {};  ///< asked before each pass; may be empty
};

enum class AutocovarianceStatus {
  not_run,
  solved,
  no_uniform_stretch,  ///< none of one model, one sample time and all outputs that is long enough
  no_gain,             ///< no predictor of a constant gain is stable
  not_computed,        ///< an innovation without variance, too many outputs, Student's tails
  not_converged,       ///< the least squares ended at their limit of iterations
};

[[nodiscard]] std::string to_string(AutocovarianceStatus status);

/// Autocovariances of the innovations of x⁺ = F (x + M e) + B u, e = y - C x - D u.
struct InnovationAutocovariances {
  double dt = 0;                    ///< [s] from one measurement to the next
  Eigen::MatrixXd M;                ///< (nx × ny) with F (I - M C) stable
  std::vector<Eigen::MatrixXd> of;  ///< lags 0, 1, …: (ny × ny) mean of e[k+j] e[k]ᵀ
  std::vector<double> pairs;        ///< that each mean is of
};

struct AutocovarianceFit {
  AutocovarianceStatus status = AutocovarianceStatus::not_run;
  Eigen::VectorXd theta;  ///< (p) as start_of(); of a variance that is zero a very small one
  /// (p × p) of ½ the misfit, the inverse of θ's covariance; zero rows for what is not free.
  Eigen::MatrixXd information;
  std::vector<FittedParameter> parameters;
  std::vector<std::string> unseen;       ///< as NoiseFit::unseen
  InnovationAutocovariances innovation;  ///< of the last gain
  double samples = 0;                    ///< innovations, of all outputs at one instant each
  int passes = 0;                        ///< gains chosen
  /// Sum of squares of what is left, in standard deviations: χ² of so many degrees of freedom where
  /// the model is right.
  double misfit = std::numeric_limits<double>::quiet_NaN();
  int degrees = 0;
  std::string culprit;

  [[nodiscard]] bool solved() const { return status == AutocovarianceStatus::solved; }
};

/// Least squares, weighted by the covariance that sample autocovariances of normal noise have, over
/// variances ≥ 0 and full blocks by their factors; by Ceres. Takes the stretches in which all
/// outputs that are measured at all come at each instant, every dt seconds; inputs may change in
/// between. Priors count. Theory: "Covariances from logs".
///
/// @throws InvalidInput  as validate() of the model and of each record; for options out of range.
/// @throws Interrupted   when `interrupted` says so.
/// Sources: Odelson, Rajamani and Rawlings 2006; Rajamani and Rawlings 2009.
[[nodiscard]] AutocovarianceFit fit_autocovariances(const FilterModel& model,
                                                    const std::vector<FilterRecord>& records,
                                                    const AutocovarianceOptions& options = {});

/// The same in the words of a fit by likelihood, with the likelihood at θ and before.
/// @param likelihood  of the same model and records
[[nodiscard]] NoiseFit as_noise_fit(const AutocovarianceFit& fit,
                                    const InnovationLikelihood& likelihood);

/// The same from autocovariances that are given, of all the model's outputs; one pass.
/// @throws InvalidInput  for shapes, pairs that are not positive, a period that is none.
[[nodiscard]] AutocovarianceFit fit_autocovariances(const FilterModel& model,
                                                    const InnovationAutocovariances& given,
                                                    const AutocovarianceOptions& options = {});

/// What the model says that they are at θ, all outputs measured every dt seconds.
/// @param M     (nx × ny) with F (I - M C) stable
/// @param lags  ≥ 0, the greatest lag
/// @throws InvalidInput  for shapes, a period that is none, or a gain that is not stable.
[[nodiscard]] std::vector<Eigen::MatrixXd> innovation_autocovariances(
    const FilterModel& model, double dt, const Eigen::Ref<const Eigen::MatrixXd>& M,
    const Eigen::Ref<const Eigen::VectorXd>& theta, int lags);

}  // namespace quadtune
