// SPDX-License-Identifier: Apache-2.0
/// Logs and the results from them, as text, JSON and pages. The results are only declared here;
/// include the header of a result to use it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "report/page/tuning_page.hpp"

namespace quadtune {
struct CalibratedImu;
struct LogSurvey;
struct ModelNeeds;
struct NoiseEvidence;
struct SensorAllan;
struct TunedNoise;
}  // namespace quadtune

namespace quadtune::report {

/// A survey of a log. The keys are documented in docs/cli.md; unknown values are null.
/// @param models  which signals of each filter model the log contains
[[nodiscard]] internal::Json to_json(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                                     const std::string& file);
[[nodiscard]] std::string to_text(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                                  const std::string& file);

/// The noise covariances that were estimated for a filter.
[[nodiscard]] internal::Json to_json(const TunedNoise& tuned);
[[nodiscard]] std::string to_text(const TunedNoise& tuned);
/// Logs, fit and increase of the likelihood: headings and texts for the page.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> facts_of(const TunedNoise& tuned);
/// @param command  the command line that produced it; may be empty
[[nodiscard]] TuningPage page_of(const TunedNoise& tuned, const NoiseEvidence& evidence,
                                 std::uint64_t seed, const std::string& command);

/// The Allan deviation of a sensor and the noise components that it shows.
[[nodiscard]] internal::Json to_json(const SensorAllan& allan);
[[nodiscard]] std::string to_text(const SensorAllan& allan);

/// A calibration of inertial sensors.
/// @param file  file of the calibration that was written; empty for none
[[nodiscard]] internal::Json to_json(const CalibratedImu& imu, const std::string& file);
[[nodiscard]] std::string to_text(const CalibratedImu& imu, const std::string& file);

}  // namespace quadtune::report
