// SPDX-License-Identifier: Apache-2.0
/// imu_calib.txt: how the uquad flight program turns counts of its inertial sensors into units.
#pragma once

#include <Eigen/Core>
#include <string>

namespace quadtune {

/// The file's name, by which the flight program finds it.
inline constexpr char kImuCalibrationName[] = "imu_calib.txt";

/// The numbers of imu_calib.txt. A sensor's reading is M (raw - b + d (t - t0)), M = T K⁻¹.
struct ImuCalibrationFile {
  /// One three-axis sensor.
  struct Sensor {
    Eigen::Matrix3d M = Eigen::Matrix3d::Identity();  ///< T K⁻¹ [unit per count]
    Eigen::Vector3d b = Eigen::Vector3d::Zero();      ///< [counts]
  };
  Sensor accelerometer;  ///< [m/s²]
  Sensor gyroscope;      ///< [rad/s]
  Sensor magnetometer;   ///< [1], of the field's norm

  bool with_temperature = true;            ///< false: the older file of 36 numbers, which ends here
  double accelerometer_z_coefficient = 0;  ///< [counts/°C]
  double accelerometer_t0 = 0;             ///< [°C]
  Eigen::Vector3d gyroscope_coefficient = Eigen::Vector3d::Zero();  ///< [counts/°C]
  Eigen::Vector3d gyroscope_constant = Eigen::Vector3d::Zero();     ///< [counts]
  double gyroscope_t0 = 0;                                          ///< [°C]
};

/// The file's text: M of a sensor in three rows, its b in three more, a blank line between sensors;
/// then the temperature terms. Numbers read back to the same double.
/// @throws InvalidInput  for a number that is not finite.
[[nodiscard]] std::string imu_calibration_text(const ImuCalibrationFile& calibration);

/// Reads 36 or 45 numbers, separated by blanks and lines in any way, as the flight program scans
/// them.
/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: …" for a word, a comma, a number that is not finite, a
/// matrix
///                       that cannot be inverted, or any other count, with the line on which it
///                       ends.
[[nodiscard]] ImuCalibrationFile parse_imu_calibration(const std::string& text,
                                                       const std::string& origin);

/// @throws InvalidInput  as parse_imu_calibration(); FileError  if the file cannot be read.
[[nodiscard]] ImuCalibrationFile read_imu_calibration(const std::string& path);

}  // namespace quadtune
