// SPDX-License-Identifier: Apache-2.0
/// A made-up inertial sensor that is turned from pose to pose: logs whose calibration is known.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "quadtune/tuning/still.hpp"

namespace quadtune {

/// How the sensor is handled. It stands level, is turned about its own axes by quarter turns so
/// that every axis points up and down, and then at random.
struct MadeUpImuOptions {
  std::uint64_t seed = 1;
  int poses = 36;            ///< at least 2
  double rate = 100;         ///< [Hz]
  double still = 3;          ///< length of a pose [s]
  double start = 6;          ///< length of the first one [s]
  double turn = 1.5;         ///< length of a turn [s]
  double noise = 1;          ///< times the noise of a small vehicle's sensors
  bool upright = false;      ///< turns about the vertical alone: what such a log cannot tell
  double warming = 0;        ///< from the first to the last pose [°C]
  bool gyroscope = true;     ///< whether there is one
  bool magnetometer = true;  ///< likewise
};

/// raw = M⁻¹ true + b - d (t - t0) + noise, rounded to whole counts. The names as in
/// SensorCalibration.
struct MadeUpSensor {
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
};

struct MadeUpImu {
  ImuLog log;  ///< counts, as the uquad's sensors give
  MadeUpSensor accelerometer, gyroscope, magnetometer;
  double t0 = 25;  ///< reference temperature of the d [°C]
  double gravity = 9.80665;
};

/// @throws InvalidInput  for options out of range.
[[nodiscard]] MadeUpImu make_up_imu(const MadeUpImuOptions& options = {});

/// A record of a still gyroscope.
struct MadeUpGyroscope {
  Eigen::VectorXd rate;         ///< [rad/s]
  double sample_rate = 100;     ///< [Hz]
  double noise_density = 1e-4;  ///< [rad/s/√Hz]
  double random_walk = 2e-5;    ///< [rad/s²/√Hz]
};

/// Half an hour of white noise and a random walk on a constant bias.
[[nodiscard]] MadeUpGyroscope make_up_gyroscope(std::uint64_t seed = 1);

}  // namespace quadtune
