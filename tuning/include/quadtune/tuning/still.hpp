// SPDX-License-Identifier: Apache-2.0
/// Raw logs of an inertial sensor, and where in them it stood still.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace quadtune {

/// What an inertial sensor recorded, as it came: counts, or any unit. A sensor that is absent has
/// no columns.
struct ImuLog {
  std::string name;                ///< of the file, for messages
  Eigen::VectorXd t;               ///< (n) [s], increasing
  Eigen::Matrix3Xd accelerometer;  ///< (3 × n)
  Eigen::Matrix3Xd gyroscope;      ///< (3 × n) or (3 × 0)
  Eigen::Matrix3Xd magnetometer;   ///< (3 × n) or (3 × 0)
  Eigen::VectorXd temperature;     ///< (n) or (0) [°C]
};

/// @throws InvalidInput  naming the log and the sample: times that do not increase, columns of
/// other
///                       lengths, values that are not finite, no accelerometer, too few samples.
void validate(const ImuLog& log);

/// What counts as still. The threshold itself comes from the log.
struct StillOptions {
  double window = 0.25;   ///< length of the windows whose variances are compared [s]
  double factor = 4;      ///< a still window's variance is at most so many times the quiet ones'
  double shortest = 0.5;  ///< of a pose without its first and last window [s]
};

/// A stretch without motion, and the means over it.
struct StillPose {
  std::size_t begin = 0;                                    ///< first sample
  std::size_t end = 0;                                      ///< one past the last
  Eigen::Vector3d accelerometer = Eigen::Vector3d::Zero();  ///< raw
  Eigen::Vector3d gyroscope = Eigen::Vector3d::Zero();      ///< raw; 0 where absent
  Eigen::Vector3d magnetometer = Eigen::Vector3d::Zero();   ///< raw; 0 where absent
  double temperature = 0;                                   ///< [°C]; 0 where absent
};

/// The still poses of a log, and what made them so.
struct StillDetection {
  std::vector<StillPose> poses;  ///< in the order of time
  /// Standard deviations within a window, all axes together, up to which it is still [raw].
  double accelerometer_threshold = 0;
  double gyroscope_threshold = 0;  ///< likewise; 0 where there is no gyroscope
  /// Standard deviations of one axis within the quietest windows: the sensors' noise [raw].
  double accelerometer_noise = 0;
  double gyroscope_noise = 0;
};

/// Cuts the log into windows and takes those for still in which neither the accelerometer's nor the
/// gyroscope's variance is more than `factor` times that of the quietest tenth of all windows, and
/// in which the gyroscope says what it says in most of them (a steady turn has no variance either).
/// The first and last window of a stretch are given up, since a motion begins or ends somewhere in
/// them.
///
/// @throws InvalidInput  as validate(), and for options out of range or a log shorter than ten
///                       windows.
[[nodiscard]] StillDetection find_still(const ImuLog& log, const StillOptions& options = {});

/// What a gyroscope says before the motors start: the mean of its first samples, which the uquad
/// flight program takes off.
struct StartUpOffset {
  static constexpr Eigen::Index kSamples = 512;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< raw
  Eigen::Vector3d error = Eigen::Vector3d::Zero();   ///< standard error, from the means of 16 parts
  bool still = false;  ///< whether all of these samples are within the first still pose
};

/// @throws InvalidInput  for a log without gyroscope or with fewer than 512 samples.
[[nodiscard]] StartUpOffset start_up_offset(const ImuLog& log, const StillDetection& still);

}  // namespace quadtune
