// SPDX-License-Identifier: Apache-2.0
/// How a filter runs over its logs with the covariances before and after its noise was tuned.
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

/// Innovations and states of one record of N instants.
struct NoiseRun {
  SampleMatrix innovation;        ///< (ny × N) as FilterRun
  SampleMatrix variance;          ///< (ny × N) of the innovations
  std::vector<RunningSize> size;  ///< of each output, over a fiftieth of its innovations, 20 … 500
  bool smoothed = false;          ///< the states; else they are the filter's
  SampleMatrix x, x_variance;     ///< (nx × N) means, and their variances
};

/// The runs over one record. The gates of the sensors are open, since the record no longer contains
/// the samples that they reject.
struct NoiseRuns {
  std::size_t fitted = 0;                 ///< instants that the fit saw: its beginning
  std::optional<NoiseRun> before, after;  ///< none where the filter did not get through
};

struct ParameterProfile {
  std::size_t parameter = 0;  ///< in FilterModel::parameters
  LikelihoodProfile profile;
};

struct NoiseEvidence {
  double holdout = 0;                      ///< share of each record that was kept from the fit
  std::vector<NoiseRuns> records;          ///< of NoiseTuning::records_after
  std::vector<ParameterProfile> profiles;  ///< of the parameters that were fitted
};

/// Runs the filter and, where memory allows, the smoother over NoiseTuning::records_before and
/// records_after, and computes the profiles of the likelihood over the parts that were fitted.
/// @param tuned    with NoiseTuningOptions::keep_records
/// @param holdout  share of each record that was kept from the fit, 0 … 0.9
/// @param threads  to use; 0: one for each processor
/// @param stop     asked often; true ends it. May be empty.
/// @throws Interrupted  where `stop` says so
[[nodiscard]] NoiseEvidence noise_evidence(const TunedNoise& tuned, double holdout,
                                           std::size_t threads,
                                           const std::function<bool()>& stop = {});

}  // namespace quadtune
