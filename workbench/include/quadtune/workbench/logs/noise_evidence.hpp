// SPDX-License-Identifier: Apache-2.0
/// Filter runs over the logs with the covariances before and after tuning.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "quadtune/samples.hpp"
#include "quadtune/tuning/likelihood_profile.hpp"
#include "quadtune/tuning/running_size.hpp"
#include "quadtune/workbench/logs/tuned_noise.hpp"

namespace quadtune {

/// Innovations and states of one record with N instants.
struct NoiseRun {
  SampleMatrix innovation;        ///< (ny × N) as in FilterRun
  SampleMatrix variance;          ///< (ny × N) of the innovations
  std::vector<RunningSize> size;  ///< for each output, over a fiftieth of its innovations, 20 … 500
  bool smoothed = false;          ///< whether the states are those of the smoother, otherwise of
                                  ///< the filter
  SampleMatrix x,                 ///< (nx × N) means of the states
      x_variance;                 ///< (nx × N) their variances
};

/// The runs over one record. The gates of the sensors are open, because the record no longer
/// contains the samples that they reject.
struct NoiseRuns {
  std::size_t fitted = 0;          ///< number of instants used in the fit, from the
                                   ///< beginning
  std::optional<NoiseRun> before,  ///< with the covariances before; none if the filter failed
      after;                       ///< with those after, likewise
};

/// The profile of one parameter.
struct ParameterProfile {
  std::size_t parameter = 0;  ///< in FilterModel::parameters
  LikelihoodProfile profile;  ///< of its likelihood
};

/// Runs and profiles of a tuning.
struct NoiseEvidence {
  double holdout = 0;                      ///< share of each record that was excluded from the fit
  std::vector<NoiseRuns> records;          ///< corresponds to NoiseTuning::records_after
  std::vector<ParameterProfile> profiles;  ///< of the parameters that were fitted
};

/// Runs the filter and, if memory allows, the smoother over NoiseTuning::records_before and
/// records_after, and computes the profiles of the likelihood over the fitted parts.
/// @param tuned    with NoiseTuningOptions::keep_records
/// @param holdout  share of each record that was excluded from the fit, 0 … 0.9
/// @param threads  number of threads; 0: one per processor
/// @param stop     called often; true ends the computation. May be empty.
/// @throws Interrupted  if `stop` returns true
[[nodiscard]] NoiseEvidence noise_evidence(const TunedNoise& tuned, double holdout,
                                           std::size_t threads,
                                           const std::function<bool()>& stop = {});

}  // namespace quadtune
