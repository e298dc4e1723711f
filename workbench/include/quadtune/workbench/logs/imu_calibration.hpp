// SPDX-License-Identifier: Apache-2.0
/// Calibration of inertial sensors from their logs to the file of a flight program.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/tuning/imu_calibration.hpp"
#include "quadtune/tuning/made_up_imu.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

/// The channels of three-axis sensors: three names each, in the order x, y, z, or none for a sensor
/// that is not to be read. Where no names are set, ax ay az, gx gy gz, mx my mz and temperature are
/// read if the log has them.
struct ImuChannels {
  std::optional<std::vector<std::string>> accelerometer, gyroscope, magnetometer;
  std::optional<std::string> temperature;  ///< empty: none
  double temperature_scale = 1;            ///< [°C] a unit of that channel
};

struct ImuLogOptions {
  std::vector<std::string> logs;         ///< of one device, which stands in many poses
  std::optional<std::uint64_t> made_up;  ///< the seed of a made-up device instead of logs
  ImuChannels channels = {};
  LogOptions reading = {};
  ImuCalibrationOptions calibration = {};
  LogNote note = {};  ///< takes warnings
};

/// What was calibrated, and what came out.
struct CalibratedImu {
  std::vector<ImuLog> logs;
  ImuCalibrationOptions options;
  ImuCalibration found;
  std::optional<MadeUpImu> truth;     ///< of a made-up device
  std::vector<std::string> warnings;  ///< of the logs' readers
};

/// Reads logs and calibrates the sensors that they have.
/// @throws OptionError    for other than three channels of a sensor: "gyroscope" and the like
/// @throws MissingOption  for a log without accelerometer; and as read_sensors()
/// @throws NoSolution     for a sensor whose parameters the poses do not determine
/// @throws InvalidInput, FileError  as read_sensors(), join() and calibrate_imu()
[[nodiscard]] CalibratedImu calibrate_from_logs(const ImuLogOptions& options);

/// The file's numbers: those that were found, and of sensors that the logs do not have those of
/// `base`.
/// @throws MissingOption  "base", where such a sensor's are needed and did not come
[[nodiscard]] ImuCalibrationFile calibration_file(const ImuCalibration& found,
                                                  const std::optional<ImuCalibrationFile>& base);

}  // namespace quadtune
