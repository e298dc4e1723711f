// SPDX-License-Identifier: Apache-2.0
/// A model and its logs in, covariances with a verdict out: the fit, its innovations, and a stretch
/// of each log that the fit has not seen.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/consistency.hpp"
#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {

struct NoiseTuningOptions {
  NoiseFitOptions fit;
  ConsistencyOptions consistency;
  double holdout = 0.2;  ///< share of each record, its end, that is kept from the fit; 0 … 0.9
};

/// The same stretch by the covariances before and after.
struct HoldOut {
  Eigen::Index innovations = 0;  ///< that were compared; 0: there is no such stretch
  double before = std::numeric_limits<double>::quiet_NaN();  ///< log-likelihood an innovation
  double after = std::numeric_limits<double>::quiet_NaN();
  CheckVerdict verdict = CheckVerdict::too_short;
  std::string reason;  ///< where it does not pass
};

struct NoiseTuning {
  NoiseFit fit;
  Consistency before;  ///< with the covariances that the model started with
  Consistency after;
  HoldOut holdout;
  /// Pass: the fit converged, every parameter is seen or zero or fixed, the innovations are
  /// consistent, and the stretch held out is not less likely than before.
  CheckVerdict verdict = CheckVerdict::too_short;
  std::vector<std::string> reasons;  ///< of a verdict that is not pass
};

/// @throws InvalidInput  as InnovationLikelihood, fit_noise() and check_consistency(); for a
/// holdout
///                       out of range.
[[nodiscard]] NoiseTuning tune_noise(const FilterModel& model,
                                     const std::vector<FilterRecord>& records,
                                     const NoiseTuningOptions& options = {});

/// The model with θ as its parameters' starts.
[[nodiscard]] FilterModel with_noise(FilterModel model,
                                     const Eigen::Ref<const Eigen::VectorXd>& theta);

}  // namespace quadtune
