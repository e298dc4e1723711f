// SPDX-License-Identifier: Apache-2.0
/// Calibrates inertial sensors from their logs for the file of a flight program.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/tuning/imu_calibration.hpp"
#include "quadtune/tuning/simulated_imu.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

/// The channels of three-axis sensors: three names each, in the order x, y, z, or an empty list for
/// a sensor that must not be read. By default, ax ay az, gx gy gz, mx my mz and temperature are
/// read if the log has them.
struct ImuChannels {
  std::optional<std::vector<std::string>>
      accelerometer,                       ///< names of the channels of the specific force
      gyroscope,                           ///< names of the channels of the rates
      magnetometer;                        ///< names of the channels of the magnetic field
  std::optional<std::string> temperature;  ///< empty: none
  double temperature_scale = 1;            ///< [°C] per unit of that channel
};

/// Logs, and how they are read and calibrated.
struct ImuLogOptions {
  std::vector<std::string> logs;           ///< logs of one device that is stationary in many poses
  std::optional<std::uint64_t> made_up;    ///< seed of a simulated device instead of logs
  ImuChannels channels = {};               ///< names of the sensors' channels
  LogOptions reading = {};                 ///< how the logs are read
  ImuCalibrationOptions calibration = {};  ///< options of the fit
  LogNote note = {};                       ///< receives warnings
};

/// A calibration with its input.
struct CalibratedImu {
  std::vector<ImuLog> logs;           ///< in raw units
  ImuCalibrationOptions options;      ///< of the fit
  ImuCalibration found;               ///< the calibration
  std::optional<SimulatedImu> truth;  ///< of a simulated device
  std::vector<std::string> warnings;  ///< from the readers of the logs
};

/// Reads logs and calibrates the sensors that they contain.
/// @throws OptionError    if a sensor does not have three channels: "gyroscope" etc.
/// @throws MissingOption  if a log has no accelerometer; and as read_sensors()
/// @throws NoSolution     if the poses do not determine the parameters of a sensor
/// @throws InvalidInput, FileError  as read_sensors(), join() and calibrate_imu()
[[nodiscard]] CalibratedImu calibrate_from_logs(const ImuLogOptions& options);

/// The numbers of the calibration file: those that were estimated, and for sensors that the logs
/// lack those of `base`.
/// @throws MissingOption  "base", if such numbers are needed and there is no base
[[nodiscard]] ImuCalibrationFile calibration_file(const ImuCalibration& found,
                                                  const std::optional<ImuCalibrationFile>& base);

}  // namespace quadtune
