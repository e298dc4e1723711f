// SPDX-License-Identifier: Apache-2.0
/// How a calibration of inertial sensors looks, as text and as JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/logs/imu_calibration.hpp"

namespace quadtune::report {

/// @param file  of the numbers that was written; empty for none
[[nodiscard]] internal::Json to_json(const CalibratedImu& imu, const std::string& file);
[[nodiscard]] std::string to_text(const CalibratedImu& imu, const std::string& file);

}  // namespace quadtune::report
