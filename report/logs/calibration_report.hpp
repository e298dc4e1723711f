// SPDX-License-Identifier: Apache-2.0
/// How a calibration of inertial sensors looks, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/tuning/imu_calibration.hpp"
#include "quadtune/tuning/made_up_imu.hpp"

namespace quadtune::report {

/// What was calibrated, and what came out.
struct CalibrationReport {
  const std::vector<ImuLog>& logs;
  const ImuCalibrationOptions& options;
  const ImuCalibration& found;
  const MadeUpImu* truth;                    ///< of a made-up log; nullptr of a real one
  const std::string& file;                   ///< that was written; empty for none
  const std::vector<std::string>& warnings;  ///< of the logs' readers
};

[[nodiscard]] internal::Json to_json(const CalibrationReport& report);
[[nodiscard]] std::string to_text(const CalibrationReport& report);

}  // namespace quadtune::report
