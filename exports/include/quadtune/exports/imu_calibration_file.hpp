// SPDX-License-Identifier: Apache-2.0
/// imu_calib.txt: the file from which the uquad flight program reads the calibration that converts
/// the counts of its inertial sensors to units.
#pragma once

#include <Eigen/Core>
#include <string>

namespace quadtune {

/// The name under which the flight program opens the file.
inline constexpr char kImuCalibrationName[] = "imu_calib.txt";

/// The numbers of imu_calib.txt. A calibrated sample is M (raw - b + d (t - t0)), M = T K⁻¹.
struct ImuCalibrationFile {
  /// One three-axis sensor.
  struct Sensor {
    Eigen::Matrix3d M = Eigen::Matrix3d::Identity();  ///< T K⁻¹ [unit per count]
    Eigen::Vector3d b = Eigen::Vector3d::Zero();      ///< [counts]
  };
  Sensor accelerometer;  ///< [m/s²]
  Sensor gyroscope;      ///< [rad/s]
  Sensor magnetometer;   ///< [1], relative to the norm of the field

  bool with_temperature = true;            ///< false: older file of 36 numbers, without the
                                           ///< following ones
  double accelerometer_z_coefficient = 0;  ///< [counts/°C]
  double accelerometer_t0 = 0;             ///< [°C]
  Eigen::Vector3d gyroscope_coefficient = Eigen::Vector3d::Zero();  ///< [counts/°C]
  Eigen::Vector3d gyroscope_constant = Eigen::Vector3d::Zero();     ///< [counts]
  double gyroscope_t0 = 0;                                          ///< [°C]
};

/// The text of the file: for each sensor M in three rows and b in three more, with a blank line
/// between sensors; then the temperature terms. Numbers read back to the same double.
/// @throws InvalidInput  if a number is not finite
[[nodiscard]] std::string imu_calibration_text(const ImuCalibrationFile& calibration);

/// Reads 36 or 45 numbers, separated by any white space, as the flight program scans them.
/// @param text    content of the file
/// @param origin  name of the file in messages
/// @throws InvalidInput  "origin:line: …" for a word, a comma, a number that is not finite, a
///                       singular matrix or any other count; for a wrong count the line is that of
///                       the end
[[nodiscard]] ImuCalibrationFile parse_imu_calibration(const std::string& text,
                                                       const std::string& origin);

/// @throws InvalidInput  as parse_imu_calibration(); FileError  if the file cannot be read.
[[nodiscard]] ImuCalibrationFile read_imu_calibration(const std::string& path);

}  // namespace quadtune
