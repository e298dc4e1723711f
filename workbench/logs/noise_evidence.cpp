// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/noise_evidence.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/tuning/smoother.hpp"

namespace quadtune {
namespace {

using Eigen::Index;

/// Maximum number of covariance entries for the smoother; above it, the filter's states are used.
constexpr double kMaxEntries = 5e7;

/// Window of the running mean: enough innovations to be steady, few enough to resolve changes.
int window_of(Index innovations) {
  return static_cast<int>(std::clamp<Index>(innovations / 50, 20, 500));
}

/// Smooths the states if possible.
void smooth_states(const FilterModel& model, const Eigen::VectorXd& theta,
                   const FilterRecord& record, NoiseRun& run) {
  const Index nx = run.x.rows(), N = record.samples();
  if (!(static_cast<double>(N) * static_cast<double>(nx * nx) < kMaxEntries)) return;
  const SmoothedStates states = smooth(model, theta, record);
  if (!states.solved()) return;
  run.smoothed = true;
  run.x = states.x;
  run.x_variance.resize(nx, N);
  for (Index k = 0; k < N; ++k) run.x_variance.col(k) = states.P.middleCols(k * nx, nx).diagonal();
}

std::optional<NoiseRun> run_of(const FilterModel& model, const Eigen::VectorXd& theta,
                               const FilterRecord& record) {
  FilterRun filter = InnovationLikelihood(model, {record}).run(0, theta);
  if (filter.status != LikelihoodStatus::computed) return std::nullopt;
  NoiseRun run;
  for (Index row = 0; row < filter.innovation.rows(); ++row) {
    const Index missing = filter.innovation.row(row).array().isNaN().count();
    run.size.push_back(
        normalized_innovation_window(filter, row, window_of(record.samples() - missing)));
  }
  run.innovation = std::move(filter.innovation);
  run.variance = std::move(filter.variance);
  run.x = std::move(filter.x);
  run.x_variance = std::move(filter.x_variance);
  smooth_states(model, theta, record, run);
  return run;
}

/// @param records  as used in the fit
std::vector<ParameterProfile> profiles_of(const TunedNoise& tuned,
                                          const std::vector<FilterRecord>& records,
                                          std::size_t threads, const std::function<bool()>& stop) {
  const NoiseFit& fit = tuned.tuning.fit;
  InnovationLikelihood likelihood(tuned.model, records);
  likelihood.stop_when(stop);
  std::vector<ParameterProfile> profiles;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    if (fit.parameters[i].verdict != ParameterVerdict::fixed &&
        fit.parameters[i].verdict != ParameterVerdict::not_known)
      profiles.push_back({i, {}});
  internal::in_parallel(
      profiles.size(), internal::thread_count(threads),
      [&]() -> internal::PartWorker {
        return [&, copy = likelihood](std::size_t part) {
          ParameterProfile& one = profiles[part];
          one.profile = likelihood_profile(copy, fit, static_cast<int>(one.parameter));
        };
      },
      stop);
  return profiles;
}

}  // namespace

NoiseEvidence noise_evidence(const TunedNoise& tuned, double holdout, std::size_t threads,
                             const std::function<bool()>& stop) {
  const NoiseTuning& tuning = tuned.tuning;
  NoiseEvidence evidence;
  evidence.holdout = holdout;
  evidence.records.resize(tuning.records_after.size());
  {
    const std::vector<FilterRecord> fitted = fitted_parts(tuning.records_after, holdout);
    for (std::size_t r = 0; r < fitted.size(); ++r)
      evidence.records[r].fitted = static_cast<std::size_t>(fitted[r].samples());
    evidence.profiles = profiles_of(tuned, fitted, threads, stop);
  }
  FilterModel open = tuned.model;
  for (FilterSensor& sensor : open.sensors) sensor.gate = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd start = start_of(tuned.model);
  for (std::size_t r = 0; r < evidence.records.size(); ++r) {
    if (r < tuning.records_before.size())
      evidence.records[r].before = run_of(open, start, tuning.records_before[r]);
    evidence.records[r].after = run_of(open, tuning.fit.theta, tuning.records_after[r]);
  }
  return evidence;
}

}  // namespace quadtune
