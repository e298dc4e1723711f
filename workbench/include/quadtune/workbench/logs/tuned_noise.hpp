// SPDX-License-Identifier: Apache-2.0
/// The noise covariances of a filter from logs, and the filter with them.
#pragma once

#include <string>
#include <vector>

#include "quadtune/tuning/noise_tuning.hpp"
#include "quadtune/workbench/logs/noise_logs.hpp"

namespace quadtune {

/// What was tuned on what, and what came out.
struct TunedNoise {
  FilterModel model;  ///< as it came, with the starts
  std::vector<TunedLog> logs;
  NoiseTuning tuning;
};

/// Tunes a linear or a nonlinear filter on the records of all logs together.
/// @param logs  at least one
/// @return      where no start has a likelihood, tuning.fit is NoiseFitStatus::not_computed
/// @throws InvalidInput  as tune_noise() of records
/// @throws Interrupted   as nonlinear_filter(), by options.fit.interrupted
[[nodiscard]] TunedNoise tune_noise(NoiseLogs logs, const NoiseTuningOptions& options = {});

/// The tuned model as a file that says from what it came and how it was judged.
/// @param command  that made it, for a comment
[[nodiscard]] std::string tuned_model_file(const TunedNoise& tuned, const std::string& command);

}  // namespace quadtune
