// SPDX-License-Identifier: Apache-2.0
/// Calibration of a gyroscope by turns between poses with known gravity.
#pragma once

#include <vector>

#include "imu/norm_calibration.hpp"
#include "quadtune/tuning/imu_calibration.hpp"

namespace quadtune {

/// A stretch of a log between two poses.
struct Turn {
  const ImuLog* log = nullptr;
  std::size_t first = 0;  ///< index of the pose before it, among all poses
  std::size_t begin = 0;  ///< first sample
  std::size_t end = 0;    ///< one past the last
};

struct TurnProblem {
  std::vector<StationaryPose> poses;
  std::vector<Turn> turns;  ///< each between two consecutive poses
  NormSolution accelerometer;
  double noise = 0;  ///< of a sample of the gyroscope [raw]
  bool with_temperature = false;
  double max_error = 0.05;
};

/// Fits the 9 + 3 parameters of the gyroscope together with those of the accelerometer and with the
/// vertical of each pose, so that the errors of all of them contribute to those of the gyroscope.
[[nodiscard]] SensorCalibration turn_calibration(const TurnProblem& problem);

}  // namespace quadtune
