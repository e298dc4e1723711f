// SPDX-License-Identifier: Apache-2.0
/// Autocovariance least squares: noise covariances estimated from the autocovariances of the
/// innovations of a predictor with a constant gain.
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

/// Options of fit_autocovariances().
struct AutocovarianceOptions {
  /// Number of groups of lags in addition to lag 0, ≥ 1. Each group is a single lag if that many
  /// lags cover the memory of the predictor; otherwise later lags are averaged in groups of
  /// increasing width.
  int lags = 15;
  int passes = 10;  ///< maximum number of times the gain is recomputed from the estimate, ≥ 1
  double confidence = 0.95;  ///< of the intervals, 0 … 1
  bool profile = false;      ///< intervals from the profile of the misfit instead of its curvature
  /// Called before each pass; true interrupts the fit; may be empty
  std::function<bool()> interrupted = {};
};

/// How the fit ended.
enum class AutocovarianceStatus {
  not_run,
  solved,
  /// No stretch with one model, one sample time and all outputs is long enough
  no_uniform_stretch,
  no_gain,  ///< no predictor with a constant gain is stable
  /// An innovation without variance, too many outputs, or a Student's distribution
  not_computed,
  not_converged,  ///< the least squares reached the maximum number of iterations
};

/// In words, e.g. "solved".
[[nodiscard]] std::string to_string(AutocovarianceStatus status);

/// Autocovariances of the innovations of the predictor x⁺ = F (x + M e) + B u, e = y - C x - D u.
struct InnovationAutocovariances {
  double dt = 0;                    ///< time from one measurement to the next [s]
  Eigen::MatrixXd M;                ///< (nx × ny) with F (I - M C) stable
  std::vector<Eigen::MatrixXd> of;  ///< lags 0, 1, …: (ny × ny) mean of e[k+j] e[k]ᵀ
  std::vector<double> pairs;        ///< number of pairs in each mean
};

/// Estimated covariances with their uncertainty.
struct AutocovarianceFit {
  /// Solved, or why there is no estimate.
  AutocovarianceStatus status = AutocovarianceStatus::not_run;
  Eigen::VectorXd theta;  ///< (p) as start_of(); a very small value for a variance that is zero
  /// (p × p) Hessian of ½ the misfit, the inverse of the covariance of θ; zero rows for parameters
  /// that are not free.
  Eigen::MatrixXd information;
  std::vector<FittedParameter> parameters;  ///< p, in the order of the model
  std::vector<std::string> unseen;          ///< as NoiseFit::unseen
  InnovationAutocovariances innovation;     ///< for the last gain
  /// Number of innovation vectors, each with all outputs of one instant
  double samples = 0;
  int passes = 0;  ///< number of gains that were computed
  /// Sum of squared residuals in standard deviations: χ² with `degrees` degrees of freedom if the
  /// model is right.
  double misfit = std::numeric_limits<double>::quiet_NaN();
  int degrees = 0;      ///< degrees of freedom of the misfit
  std::string culprit;  ///< why it is not solved; empty if it is

  /// Whether there is an estimate.
  [[nodiscard]] bool solved() const { return status == AutocovarianceStatus::solved; }
};

/// Weighted least squares over variances ≥ 0 and over full blocks parametrized by their factors,
/// solved by Ceres. The weights are the inverse covariance of sample autocovariances of normal
/// noise. The fit uses the stretches in which all outputs that are measured at all have a
/// measurement at each instant, every dt seconds; inputs may change in between. Priors are
/// included. Theory: "Covariances from logs".
///
/// @throws InvalidInput  as validate() of the model and of each record; for options out of range.
/// @throws Interrupted  if `interrupted` returns true.
/// Sources: Odelson, Rajamani and Rawlings 2006; Rajamani and Rawlings 2009.
[[nodiscard]] AutocovarianceFit fit_autocovariances(const FilterModel& model,
                                                    const std::vector<FilterRecord>& records,
                                                    const AutocovarianceOptions& options = {});

/// Converts the result to a NoiseFit, with the likelihood at θ and at the start.
/// @param fit         solved
/// @param likelihood  of the same model and records
[[nodiscard]] NoiseFit as_noise_fit(const AutocovarianceFit& fit,
                                    const InnovationLikelihood& likelihood);

/// Fits given autocovariances of all outputs of the model, in one pass.
/// @throws InvalidInput  for wrong shapes, or pairs or a period that are not positive.
[[nodiscard]] AutocovarianceFit fit_autocovariances(const FilterModel& model,
                                                    const InnovationAutocovariances& given,
                                                    const AutocovarianceOptions& options = {});

/// Computes the autocovariances that the model predicts at θ if all outputs are measured every dt
/// seconds.
/// @param model  linear, accepted by validate()
/// @param dt     sample period [s], > 0
/// @param M      (nx × ny) with F (I - M C) stable
/// @param theta  as start_of()
/// @param lags   ≥ 0, the largest lag
/// @throws InvalidInput  for wrong shapes, a period that is not positive, or a gain that is not
///                       stable.
[[nodiscard]] std::vector<Eigen::MatrixXd> innovation_autocovariances(
    const FilterModel& model, double dt, const Eigen::Ref<const Eigen::MatrixXd>& M,
    const Eigen::Ref<const Eigen::VectorXd>& theta, int lags);

}  // namespace quadtune
