// SPDX-License-Identifier: Apache-2.0
/// Raw logs of an inertial sensor, and the stretches in which it is stationary.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace quadtune {

/// Raw samples of an inertial sensor, in counts or any unit. A sensor that is absent has no
/// columns.
struct ImuLog {
  std::string name;                ///< name of the file, for messages
  Eigen::VectorXd t;               ///< (n) [s], increasing
  Eigen::Matrix3Xd accelerometer;  ///< (3 × n)
  Eigen::Matrix3Xd gyroscope;      ///< (3 × n) or (3 × 0)
  Eigen::Matrix3Xd magnetometer;   ///< (3 × n) or (3 × 0)
  Eigen::VectorXd temperature;     ///< (n) or (0) [°C]
};

/// @throws InvalidInput  naming the log and the sample: times that do not increase, columns of
///                       different lengths, values that are not finite, no accelerometer, too few
///                       samples.
void validate(const ImuLog& log);

/// Criteria of a stationary stretch. The threshold itself is computed from the log.
struct StationaryOptions {
  double window = 0.25;   ///< duration of the windows whose variances are compared [s]
  double factor = 4;      ///< maximum variance of a stationary window relative to the quietest ones
  double shortest = 0.5;  ///< minimum duration of a pose without its first and last window [s]
};

/// A stationary stretch, and the means over it.
struct StationaryPose {
  std::size_t begin = 0;                                    ///< first sample
  std::size_t end = 0;                                      ///< one past the last
  Eigen::Vector3d accelerometer = Eigen::Vector3d::Zero();  ///< raw
  Eigen::Vector3d gyroscope = Eigen::Vector3d::Zero();      ///< raw; 0 where absent
  Eigen::Vector3d magnetometer = Eigen::Vector3d::Zero();   ///< raw; 0 where absent
  double temperature = 0;                                   ///< [°C]; 0 where absent
};

/// The stationary poses of a log, and the thresholds of their detection.
struct StationaryDetection {
  std::vector<StationaryPose> poses;  ///< in time order
  /// Maximum standard deviation within a stationary window, all axes combined [raw].
  double accelerometer_threshold = 0;
  double gyroscope_threshold = 0;  ///< likewise; 0 if there is no gyroscope
  /// Standard deviation of one axis within the quietest windows: the noise of the sensors [raw].
  double accelerometer_noise = 0;
  double gyroscope_noise = 0;  ///< likewise; 0 if there is no gyroscope
};

/// Splits the log into windows. A window is stationary if neither the variance of the accelerometer
/// nor that of the gyroscope exceeds `factor` times that of the quietest tenth of all windows, and
/// if the mean of the gyroscope agrees with that of most such windows (a steady turn has no
/// variance either). The first and last window of a stretch are discarded, since a motion begins or
/// ends in them.
///
/// @throws InvalidInput  as validate(), and for options out of range or a log shorter than ten
///                       windows.
[[nodiscard]] StationaryDetection find_stationary(const ImuLog& log,
                                                  const StationaryOptions& options = {});

/// Offset of a gyroscope before the motors start: the mean of its first samples, which the uquad
/// flight program subtracts.
struct StartUpOffset {
  static constexpr Eigen::Index kSamples = 512;      ///< number of samples of the mean
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< raw
  Eigen::Vector3d error = Eigen::Vector3d::Zero();   ///< standard error, from the means of 16 parts
  bool still = false;  ///< whether all of these samples are within the first stationary pose
};

/// @throws InvalidInput  for a log without gyroscope or with fewer than 512 samples.
[[nodiscard]] StartUpOffset start_up_offset(const ImuLog& log, const StationaryDetection& still);

}  // namespace quadtune
