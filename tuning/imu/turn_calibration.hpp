// SPDX-License-Identifier: Apache-2.0
/// Calibration of a gyroscope by turns from pose to pose, whose gravity is known.
#pragma once

#include <vector>

#include "imu/norm_calibration.hpp"
#include "quadtune/tuning/imu_calibration.hpp"

namespace quadtune {

/// A stretch of a log between two poses.
struct Turn {
  const ImuLog* log = nullptr;
  std::size_t first = 0;  ///< pose before it, of all poses
  std::size_t begin = 0;  ///< first sample
  std::size_t end = 0;    ///< one past the last
};

struct TurnProblem {
  std::vector<StillPose> poses;
  std::vector<Turn> turns;  ///< each between a pose and the next
  NormSolution accelerometer;
  double noise = 0;  ///< of a gyroscope's sample, raw
  bool with_temperature = false;
  double greatest_error = 0.05;
};

/// Fits the gyroscope's 9 + 3 numbers together with the accelerometer's and the poses' verticals,
/// so that the errors of all count in the gyroscope's.
[[nodiscard]] SensorCalibration turn_calibration(const TurnProblem& problem);

}  // namespace quadtune
