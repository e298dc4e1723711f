// SPDX-License-Identifier: Apache-2.0
/// A model and its logs in, covariances with a verdict out: the fit, its innovations, and a stretch
/// of each log that the fit has not seen.
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

/// What a sensor's gate did not let in.
struct RefusedCount {
  std::string output;         ///< "sonar: height"
  Eigen::Index refused = 0;   ///< measurements of e²/S beyond the gate
  Eigen::Index measured = 0;  ///< all of them
};

struct NoiseTuningOptions {
  NoiseMethod method = NoiseMethod::likelihood;
  NoiseFitOptions fit;  ///< of autocovariances only its confidence and profile count
  ConsistencyOptions consistency;
  bool compare = true;         ///< with the other method: NoiseTuning::agreement
  AgreementOptions agreement;  ///< what of it matters
  double holdout = 0.2;  ///< share of each record, its end, that is kept from the fit; 0 … 0.9
  /// Share of an output's measurements that a gate may refuse before they are no outliers any more.
  double most_refused = 0.05;
  bool keep_records = false;  ///< NoiseTuning::records_before and records_after
  /// Of the search, > 0. Once they are over the best so far is judged, which takes a few more runs
  /// of the filter; the fit is then NoiseFitStatus::out_of_time.
  double seconds = std::numeric_limits<double>::infinity();
  /// Called as NoiseFitOptions::progress is, which it takes the place of, with which of the fits it
  /// is, from 1. May be empty.
  std::function<void(int round, int evaluations, double best)> progress = {};
};

/// The same stretch by the covariances before and after.
struct HoldOut {
  Eigen::Index innovations = 0;  ///< that were compared; 0: there is no such stretch
  double before = std::numeric_limits<double>::quiet_NaN();  ///< log-likelihood an innovation
  double after = std::numeric_limits<double>::quiet_NaN();
  /// Fails where after is less than before by more than chance does, innovation by innovation, of
  /// however few; passes from 30 on.
  CheckVerdict verdict = CheckVerdict::too_short;
  std::string reason;  ///< where it does not pass
};

struct NoiseTuning {
  /// Where it was interrupted, that is all there is: nothing is judged.
  NoiseFit fit;
  std::optional<AutocovarianceFit> autocovariances;  ///< that the fit is of, if it is
  int rounds = 1;                       ///< fits made, each with its own path and its own refusals
  std::vector<LeftOutRecord> left_out;  ///< of the filter's logs
  std::vector<RefusedCount> refused;    ///< of the outputs whose sensor has a gate
  Consistency before;                   ///< with the covariances that the model started with
  Consistency after;
  HoldOut holdout;
  std::optional<NoiseAgreement> agreement;  ///< of a fit that converged, where asked for
  /// Of the states whose truth is told: each over the stretch held out where it is told there, else
  /// over the part that was fitted.
  std::vector<StateAccuracy> accuracy;
  /// What a user has to know whatever the verdict: a sensor that hangs, methods that disagree, a
  /// filter that is less accurate than before.
  std::vector<std::string> warnings;
  /// Pass: the fit converged, every parameter is seen or zero or fixed, the innovations are
  /// consistent, gates refuse few, and the stretch held out is not less likely than before.
  CheckVerdict verdict = CheckVerdict::too_short;
  std::vector<std::string> reasons;  ///< of a verdict that is not pass
  /// Where asked for, the whole records as the filter took them with the covariances before and
  /// after: linearized, and without what gates refused. Empty where it did not get through.
  std::vector<FilterRecord> records_before, records_after;
};

/// The parts of records that a fit with this holdout sees: their beginnings.
[[nodiscard]] std::vector<FilterRecord> fitted_parts(const std::vector<FilterRecord>& records,
                                                     double holdout);

/// Where a sensor has a gate, what it refuses is found with the covariances of a fit in which that
/// sensor's errors have long tails, taken out, and the fit is repeated until the gate refuses the
/// same. The stretch held out continues the filter's run.
///
/// @throws InvalidInput  as InnovationLikelihood, fit_noise() and check_consistency(); for options
///                       out of range.
[[nodiscard]] NoiseTuning tune_noise(const FilterModel& model,
                                     const std::vector<FilterRecord>& records,
                                     const NoiseTuningOptions& options = {});

/// The same for a nonlinear filter, linearized anew along the path of each fit's covariances until
/// they change no more. What is reported is of the extended filter itself.
[[nodiscard]] NoiseTuning tune_noise(const NonlinearFilter& filter,
                                     const NoiseTuningOptions& options = {});

/// The model with θ as its parameters' starts.
[[nodiscard]] FilterModel with_noise(FilterModel model,
                                     const Eigen::Ref<const Eigen::VectorXd>& theta);

}  // namespace quadtune
