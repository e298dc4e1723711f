// SPDX-License-Identifier: Apache-2.0
/// A simulated inertial sensor that is rotated from pose to pose: logs whose calibration is known.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "quadtune/tuning/stationary.hpp"

namespace quadtune {

/// How the sensor is moved. It starts level, is rotated about its own axes by quarter turns so that
/// every axis points up and down, and then rotated at random.
struct SimulatedImuOptions {
  std::uint64_t seed = 1;  ///< of poses, errors and noise
  int poses = 36;          ///< number of poses, at least 2
  double rate = 100;       ///< [Hz]
  double still = 3;        ///< duration of a pose [s]
  double start = 6;        ///< duration of the first pose [s]
  double turn = 1.5;       ///< duration of a turn [s]
  double noise = 1;        ///< factor on the noise of the sensors of a small vehicle
  /// Rotate about the vertical only, for a log that determines few parameters
  bool upright = false;
  double warming = 0;        ///< temperature increase from the first to the last pose [°C]
  bool gyroscope = true;     ///< whether the log has one
  bool magnetometer = true;  ///< likewise
};

/// raw = M⁻¹ true + b - d (t - t0) + noise, rounded to whole counts. The symbols are those of
/// SensorCalibration.
struct SimulatedSensor {
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();  ///< matrix of scales and axes [unit per raw]
  Eigen::Vector3d b = Eigen::Vector3d::Zero();      ///< bias [raw]
  Eigen::Vector3d d = Eigen::Vector3d::Zero();      ///< temperature coefficient [raw/°C]
};

/// A log with the true parameters of its sensors.
struct SimulatedImu {
  ImuLog log;                     ///< in counts, like the sensors of the uquad
  SimulatedSensor accelerometer,  ///< true parameters
      gyroscope,                  ///< likewise
      magnetometer;               ///< likewise
  double t0 = 25;                 ///< reference temperature of d [°C]
  double gravity = 9.80665;       ///< [m/s²]
};

/// @throws InvalidInput  for options out of range.
[[nodiscard]] SimulatedImu simulate_imu(const SimulatedImuOptions& options = {});

/// A log of a stationary gyroscope.
struct SimulatedGyroscope {
  Eigen::VectorXd rate;         ///< [rad/s]
  double sample_rate = 100;     ///< [Hz]
  double noise_density = 1e-4;  ///< [rad/s/√Hz]
  double random_walk = 2e-5;    ///< [rad/s²/√Hz]
};

/// Simulates half an hour of white noise and a random walk on a constant bias.
[[nodiscard]] SimulatedGyroscope simulate_gyroscope(std::uint64_t seed = 1);

}  // namespace quadtune
