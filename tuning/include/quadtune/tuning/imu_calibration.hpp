// SPDX-License-Identifier: Apache-2.0
/// Scale, cross-axis and bias of inertial sensors from logs in which they stand in many poses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/tuning/still.hpp"

namespace quadtune {

/// Outcome of a calibration.
enum class CalibrationStatus {
  not_run,         ///< there is no such sensor
  solved,          ///< all numbers are usable
  not_observable,  ///< the poses leave numbers open; `unseen` and `missing` name them
  no_match,        ///< the sensor's readings do not follow the poses
};
[[nodiscard]] const char* to_string(CalibrationStatus status);

/// One three-axis sensor: true = M (raw - b + d (t - t0)), M = T K⁻¹.
struct SensorCalibration {
  CalibrationStatus status = CalibrationStatus::not_run;
  std::string culprit;  ///< why not solved, on one line

  Eigen::Matrix3d T;  ///< unit diagonal; upper triangular but for a gyroscope [1]
  Eigen::Vector3d K;  ///< diagonal of K: the sensors' scales [raw per unit]
  Eigen::Matrix3d M;  ///< T K⁻¹ [unit per raw]; with all below NaN unless solved
  Eigen::Vector3d b;  ///< bias at t0 [raw]
  Eigen::Vector3d d = Eigen::Vector3d::Zero();  ///< temperature coefficient [raw/°C]; 0: not fitted
  bool with_temperature = false;                ///< whether d was fitted
  double t0 = 0;                                ///< [°C]

  Eigen::Matrix3d M_error;  ///< standard errors; 0 where the convention fixes the entry
  Eigen::Vector3d b_error;
  Eigen::Vector3d d_error = Eigen::Vector3d::Zero();
  double quantile = 0;  ///< value ± quantile · error is the 95 % interval (Student's t)

  /// Root mean square of what should vanish. Accelerometer and magnetometer: norm less gravity
  /// [m/s²] or field; gyroscope: angle between the turned and the seen gravity [rad].
  double residual_before = 0;  ///< with one scale for all axes; the gyroscope less its bias
  double residual_after = 0;

  std::size_t used = 0;              ///< poses, or turns of a gyroscope
  std::vector<std::size_t> refused;  ///< poses that were left out as outliers, from 0
  std::vector<std::string> unseen;   ///< numbers that the poses do not tell: "scale y", "bias y"
  std::vector<std::string> missing;  ///< what would tell them: "y up", "a turn about z, z level"

  SensorCalibration();
  [[nodiscard]] bool solved() const { return status == CalibrationStatus::solved; }
  /// M (raw - b + d (t - t0)).
  [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& raw, double temperature) const {
    return M * (raw - b + d * (temperature - t0));
  }
};

struct ImuCalibrationOptions {
  double gravity = 9.80665;  ///< [m/s²]
  double field = 1;          ///< norm of the magnetic field, in the unit wanted
  StillOptions still;
  /// Temperature terms are fitted where the poses span as much [°C].
  double least_temperature_span = 5;
  /// Numbers whose 95 % half interval is wider, relative to the scale or to gravity, are not seen.
  double greatest_error = 0.05;
};

/// All sensors of a log.
struct ImuCalibration {
  SensorCalibration accelerometer, gyroscope, magnetometer;
  std::vector<StillDetection> still;  ///< one a log
  std::vector<StillPose> poses;       ///< of all logs
};

/// Calibrates the sensors of one device from logs of it.
///
/// The accelerometer's and the magnetometer's norms are to be the same in every pose. The gyroscope
/// between two poses of a log is to turn the one's gravity into the other's. Needs 10 poses (11
/// with temperature) that differ; the result tells which are missing where they do not suffice.
///
/// @throws InvalidInput  as find_still(); for no log, or options out of range.
/// Source: Tedaldi, Pretto, Menegatti 2014; docs/theory.md#calibration-of-inertial-sensors.
[[nodiscard]] ImuCalibration calibrate_imu(const std::vector<ImuLog>& logs,
                                           const ImuCalibrationOptions& options = {});

}  // namespace quadtune
