// SPDX-License-Identifier: Apache-2.0
/// The random errors of the readings of a flown plant.
#pragma once

#include <Eigen/Core>

#include "flown/flown_estimator.hpp"
#include "quadtune/model/sensors.hpp"

namespace quadtune::internal {

/// Standard deviations for each axis of a reading.
struct ReadingNoise {
  Eigen::Vector3d white = Eigen::Vector3d::Zero();       ///< per sample [unit]
  Eigen::Vector3d walk = Eigen::Vector3d::Zero();        ///< [unit/√s]
  Eigen::Vector3d correlated = Eigen::Vector3d::Zero();  ///< stationary [unit]
  double correlation = 0;                                ///< its time constant [s]
};

/// Returns the random errors of one reading.
/// @param sensors  must have the sensor of the reading
/// @param height   height of the hover [m]; the noise of optical flow increases with it
[[nodiscard]] ReadingNoise reading_noise(const Sensors& sensors, Reading reading, double height);

}  // namespace quadtune::internal
