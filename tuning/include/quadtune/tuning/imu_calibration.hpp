// SPDX-License-Identifier: Apache-2.0
/// Scale, cross-axis and bias errors of inertial sensors, estimated from logs in which the device
/// is stationary in many poses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/tuning/stationary.hpp"

namespace quadtune {

/// Outcome of a calibration.
enum class CalibrationStatus {
  not_run,         ///< the log has no such sensor
  solved,          ///< all parameters are usable
  not_observable,  ///< the poses do not determine all parameters; see `unseen` and `missing`
  no_match,        ///< the samples of the sensor do not fit the poses
};

/// In words, e.g. "solved".
[[nodiscard]] const char* to_string(CalibrationStatus status);

/// One three-axis sensor: true = M (raw - b + d (t - t0)), M = T K⁻¹.
struct SensorCalibration {
  CalibrationStatus status = CalibrationStatus::not_run;  ///< solved, or why not
  std::string culprit;                                    ///< why it is not solved, on one line

  Eigen::Matrix3d T;  ///< unit diagonal; upper triangular except for a gyroscope [1]
  Eigen::Vector3d K;  ///< diagonal of K: the scales of the axes [raw per unit]
  Eigen::Matrix3d M;  ///< T K⁻¹ [unit per raw]; NaN unless solved, as are the following ones
  Eigen::Vector3d b;  ///< bias at t0 [raw]
  Eigen::Vector3d d = Eigen::Vector3d::Zero();  ///< temperature coefficient [raw/°C]; 0: not fitted
  bool with_temperature = false;                ///< whether d was fitted
  double t0 = 0;                                ///< [°C]

  Eigen::Matrix3d M_error;  ///< standard errors; 0 where the convention fixes the entry
  Eigen::Vector3d b_error;  ///< standard errors of b [raw]
  Eigen::Vector3d d_error = Eigen::Vector3d::Zero();  ///< standard errors of d [raw/°C]
  double quantile = 0;  ///< value ± quantile · error is the 95 % interval (Student's t)

  /// Root mean square residual. Accelerometer and magnetometer: norm minus gravity [m/s²] or field;
  /// gyroscope: angle between the rotated and the measured gravity [rad].
  /// Before the calibration: with one scale for all axes and, for the gyroscope, its bias
  /// subtracted.
  double residual_before = 0;
  double residual_after = 0;  ///< with the calibration

  std::size_t used = 0;  ///< number of poses, or of turns of a gyroscope
  /// Indices of the poses that were rejected as outliers, from 0
  std::vector<std::size_t> refused;
  /// Parameters that the poses do not determine: "scale y", "bias y"
  std::vector<std::string> unseen;
  /// Poses or turns that would determine them: "y up", "a turn about z, z level"
  std::vector<std::string> missing;

  SensorCalibration();
  /// Whether all parameters are usable.
  [[nodiscard]] bool solved() const { return status == CalibrationStatus::solved; }
  /// M (raw - b + d (t - t0)).
  [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& raw, double temperature) const {
    return M * (raw - b + d * (temperature - t0));
  }
};

/// Options of calibrate_imu().
struct ImuCalibrationOptions {
  double gravity = 9.80665;  ///< [m/s²]
  double field = 1;          ///< norm of the magnetic field, in the desired unit
  StationaryOptions still;   ///< how stationary stretches are found
  /// Temperature terms are fitted if the poses span at least this range [°C].
  double min_temperature_span = 5;
  /// Parameters whose 95 % half interval is wider, relative to the scale or to gravity, count as
  /// not determined.
  double max_error = 0.05;
};

/// All sensors of a log.
struct ImuCalibration {
  SensorCalibration accelerometer,         ///< specific force
      gyroscope,                           ///< body rates
      magnetometer;                        ///< magnetic field
  std::vector<StationaryDetection> still;  ///< one per log
  std::vector<StationaryPose> poses;       ///< of all logs
};

/// Calibrates the sensors of one device from its logs.
///
/// The fit makes the norms of the accelerometer and of the magnetometer the same in every pose, and
/// makes the gyroscope between two poses of a log rotate the gravity of the first pose into that of
/// the second. It requires 10 different poses (11 with temperature); if the poses do not suffice,
/// the result lists the missing ones.
///
/// @throws InvalidInput  as find_stationary(); if there is no log, or for options out of range.
/// Source: Tedaldi, Pretto, Menegatti 2014; docs/theory.md, "Calibration of inertial sensors".
[[nodiscard]] ImuCalibration calibrate_imu(const std::vector<ImuLog>& logs,
                                           const ImuCalibrationOptions& options = {});

}  // namespace quadtune
