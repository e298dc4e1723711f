// SPDX-License-Identifier: Apache-2.0
/// Tuning of noise covariances from a model and its logs, with a verdict that is based on the fit,
/// on its innovations, and on a part of each log that is held out of the fit.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/estimation/nonlinear_filter.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"
#include "quadtune/tuning/consistency.hpp"
#include "quadtune/tuning/noise_agreement.hpp"
#include "quadtune/tuning/noise_fit.hpp"
#include "quadtune/tuning/state_errors.hpp"

namespace quadtune {

/// Measurements that the gate of a sensor rejected.
struct RefusedCount {
  std::string output;         ///< "sonar: height"
  Eigen::Index refused = 0;   ///< number of measurements whose e²/S exceeds the gate
  Eigen::Index measured = 0;  ///< number of all measurements
};

/// Options of the tuning.
struct NoiseTuningOptions {
  NoiseMethod method = NoiseMethod::likelihood;  ///< how the covariances are estimated
  NoiseFitOptions fit;             ///< autocovariances use only its confidence and profile
  ConsistencyOptions consistency;  ///< limits of the checks of the innovations
  bool compare = true;         ///< whether to compare with the other method: NoiseTuning::agreement
  AgreementOptions agreement;  ///< limits of that comparison
  double holdout = 0.2;  ///< share at the end of each record that is held out of the fit; 0 … 0.9
  /// Maximum share of the measurements of an output that a gate may reject as outliers.
  double max_rejected = 0.05;
  bool keep_records = false;  ///< whether to fill NoiseTuning::records_before and records_after
  /// Time limit of the search, > 0. After it the best point so far is evaluated, which takes a few
  /// more runs of the filter; the fit is then NoiseFitStatus::out_of_time.
  double seconds = std::numeric_limits<double>::infinity();
  /// Called like NoiseFitOptions::progress, which it replaces, with the number of the fit as well,
  /// from 1. May be empty.
  std::function<void(int round, int evaluations, double best)> progress = {};
};

/// Likelihood of the held-out part with the covariances before and after the fit.
struct HoldOut {
  Eigen::Index innovations = 0;  ///< number of innovations; 0: nothing was held out
  double before = std::numeric_limits<double>::quiet_NaN();  ///< log-likelihood per innovation
  /// Log-likelihood per innovation after the fit.
  double after = std::numeric_limits<double>::quiet_NaN();
  /// Fails if `after` is significantly lower than `before`, tested innovation by innovation, with
  /// any number of them; passes only with 30 or more.
  CheckVerdict verdict = CheckVerdict::too_short;
  std::string reason;  ///< if it does not pass
};

/// A fit with everything that the verdict depends on.
struct NoiseTuning {
  /// If it was interrupted, only this is valid: there is no verdict.
  NoiseFit fit;
  /// The autocovariance fit that `fit` is converted from, if that is the method
  std::optional<AutocovarianceFit> autocovariances;
  /// Number of fits, each with its own linearization path and its own rejected measurements
  int rounds = 1;
  std::vector<LeftOutRecord> left_out;      ///< records of the logs that the filter cannot use
  std::vector<RefusedCount> refused;        ///< one per output whose sensor has a gate
  Consistency before;                       ///< with the covariances of the model
  Consistency after;                        ///< with the tuned covariances
  HoldOut holdout;                          ///< likelihood of the data that the fit did not use
  std::optional<NoiseAgreement> agreement;  ///< of a fit that converged, if requested
  /// Accuracy of the states whose true values are in the records: over the held-out part if they
  /// are known there, otherwise over the fitted part.
  std::vector<StateAccuracy> accuracy;
  /// What a user must know whatever the verdict: a sensor whose value is stuck, methods that
  /// disagree, a filter that is less accurate than before.
  std::vector<std::string> warnings;
  /// Pass: the fit converged, every parameter is determined, zero or fixed, the innovations are
  /// consistent, gates reject few measurements, and the held-out part is not less likely than
  /// before.
  CheckVerdict verdict = CheckVerdict::too_short;
  std::vector<std::string> reasons;  ///< why the verdict is not pass
  /// If requested, the complete records as the filter used them with the covariances before and
  /// after: linearized, and without the measurements that gates rejected. Empty if the filter
  /// failed.
  std::vector<FilterRecord> records_before,  ///< with the covariances before
      records_after;                         ///< with those after
};

/// The initial parts of records that a fit with this holdout uses.
[[nodiscard]] std::vector<FilterRecord> fitted_parts(const std::vector<FilterRecord>& records,
                                                     double holdout);

/// Tunes the covariances of a linear filter. If a sensor has a gate, its rejected measurements are
/// first determined with the covariances of a fit in which the errors of that sensor have a
/// heavy-tailed distribution. They are removed, and the fit is repeated until the gate rejects the
/// same measurements. The filter continues from the fitted part into the held-out part.
///
/// @throws InvalidInput  as InnovationLikelihood, fit_noise() and check_consistency(); for options
///                       out of range.
[[nodiscard]] NoiseTuning tune_noise(const FilterModel& model,
                                     const std::vector<FilterRecord>& records,
                                     const NoiseTuningOptions& options = {});

/// Tunes a nonlinear filter, which is linearized again along the path of each fit until the
/// covariances no longer change. The reported results are those of the extended filter itself.
[[nodiscard]] NoiseTuning tune_noise(const NonlinearFilter& filter,
                                     const NoiseTuningOptions& options = {});

/// Returns the model with θ as the start values of its parameters.
[[nodiscard]] FilterModel with_noise(FilterModel model,
                                     const Eigen::Ref<const Eigen::VectorXd>& theta);

}  // namespace quadtune
