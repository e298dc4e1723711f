// SPDX-License-Identifier: Apache-2.0
/// Estimates the noise covariances of a filter from logs.
#pragma once

#include <string>
#include <vector>

#include "quadtune/tuning/noise_tuning.hpp"
#include "quadtune/workbench/logs/noise_logs.hpp"

namespace quadtune {

/// The result of a tuning with its input.
struct TunedNoise {
  FilterModel model;           ///< before tuning, with the initial values
  std::vector<TunedLog> logs;  ///< what the tuning read
  NoiseTuning tuning;          ///< the result
};

/// Tunes a linear or a nonlinear filter on the records of all logs together.
/// @param logs     at least one
/// @param options  of fit, checks and comparison
/// @return         if no start has a likelihood, tuning.fit is NoiseFitStatus::not_computed
/// @throws InvalidInput  as tune_noise() for records
/// @throws Interrupted   as nonlinear_filter(), by options.fit.interrupted
[[nodiscard]] TunedNoise tune_noise(NoiseLogs logs, const NoiseTuningOptions& options = {});

/// The text of a file with the tuned model, its sources and its verdict.
/// @param tuned    from tune_noise()
/// @param command  command line that created it, for a comment
[[nodiscard]] std::string tuned_model_file(const TunedNoise& tuned, const std::string& command);

}  // namespace quadtune
