// SPDX-License-Identifier: Apache-2.0
/// Logs and what was found in them, as text, JSON and pages. The results are declared only: who has
/// one includes its header.
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

/// A survey of a log. Keys as docs/cli.md has them; what is not known is null.
/// @param models  what each filter model finds in it
[[nodiscard]] internal::Json to_json(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                                     const std::string& file);
[[nodiscard]] std::string to_text(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                                  const std::string& file);

/// The noise covariances that were found for a filter.
[[nodiscard]] internal::Json to_json(const TunedNoise& tuned);
[[nodiscard]] std::string to_text(const TunedNoise& tuned);
/// Logs, fit and gain in likelihood: headings and texts for the page.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> facts_of(const TunedNoise& tuned);
/// @param command  the command line that made it; may be empty
[[nodiscard]] TuningPage page_of(const TunedNoise& tuned, const NoiseEvidence& evidence,
                                 std::uint64_t seed, const std::string& command);

/// The Allan deviation of a sensor and the noises that it shows.
[[nodiscard]] internal::Json to_json(const SensorAllan& allan);
[[nodiscard]] std::string to_text(const SensorAllan& allan);

/// A calibration of inertial sensors.
/// @param file  of the numbers that was written; empty for none
[[nodiscard]] internal::Json to_json(const CalibratedImu& imu, const std::string& file);
[[nodiscard]] std::string to_text(const CalibratedImu& imu, const std::string& file);

}  // namespace quadtune::report
