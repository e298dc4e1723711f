// SPDX-License-Identifier: Apache-2.0
/// Lines, circles and lemniscates that start and stop smoothly, with exact derivatives.
///
/// A path is a curve with a parameter s that depends on time. s is constant until `begin`,
/// accelerates over `ramp`, increases at a constant rate, decelerates over `ramp` and is constant
/// again. While it accelerates, with u = (t - begin)/ramp in [0, 1],
///
///     s' = rate (6 u⁵ - 15 u⁴ + 10 u³),   s = rate ramp (u⁶ - 3 u⁵ + 5/2 u⁴)
///
/// The deceleration is the mirror image, so that position, velocity, acceleration and jerk are
/// continuous.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>

namespace quadtune {

/// Direction of the nose on a path.
enum class Nose {
  fixed,  ///< constant yaw
  ahead,  ///< along the path, also before its begin and after its end
};

/// Motion of a path's parameter over time, and the yaw.
struct Passage {
  double begin = 0;         ///< start of the motion [s], ≥ 0
  double ramp = 1;          ///< duration of the acceleration and of the deceleration [s], > 0
  Nose nose = Nose::fixed;  ///< where the nose points
  double yaw = 0;           ///< for Nose::fixed [rad]

  friend bool operator==(const Passage&, const Passage&) = default;
};

/// Straight line; s is the distance from `from` in the direction of `to`.
struct LinePath {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< world [m]
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< world [m]; different from `from`
  double speed = 0;                                ///< [m/s], > 0
  Passage passage;                                 ///< progress along the path and yaw

  friend bool operator==(const LinePath&, const LinePath&) = default;
};

/// Circle; s is the angle travelled: centre + |radius| (cos b, sin b, 0) at the bearing
/// b = `bearing` + s for a right turn, `bearing` - s for a left turn.
struct CirclePath {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< world [m]
  double radius = 0;   ///< [m], not 0; positive: right turn (clockwise seen from above)
  double bearing = 0;  ///< of the first point, seen from the centre [rad]; 0 is north
  double speed = 0;    ///< [m/s], > 0
  double turns = 1;    ///< > 0
  Passage passage;     ///< progress along the path and yaw

  friend bool operator==(const CirclePath&, const CirclePath&) = default;
};

/// Gerono's lemniscate; s is an angle. The position is a sin s along the long axis and b sin 2s to
/// the right of it, with 2 a = length, 2 b = width. It starts at the crossing; the distance between
/// the tips is `length`.
struct LemniscatePath {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< world [m]
  double length = 0;                                 ///< [m], > 0
  double width = 0;                                  ///< [m], > 0
  double heading = 0;                                ///< of the long axis [rad]
  /// Duration of a lap at the constant rate [s], > 0
  double lap = 0;
  double laps = 1;  ///< > 0
  Passage passage;  ///< progress along the path and yaw

  friend bool operator==(const LemniscatePath&, const LemniscatePath&) = default;
};

using SmoothPath = std::variant<LinePath, CirclePath, LemniscatePath>;  ///< Any of the paths.

/// A point that moves along a path, world axes north-east-down.
struct PathPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s²]
  double yaw = 0;                                          ///< [rad], continuous
  double yaw_rate = 0;                                     ///< [rad/s]
};

/// Point at time t [s]; the first point before the begin, the last after the end. Velocity,
/// acceleration and yaw rate are the exact derivatives of position and yaw.
[[nodiscard]] PathPoint path_point(const SmoothPath& path, double t);

/// Time at which the point has stopped [s].
[[nodiscard]] double path_end(const SmoothPath& path);

/// Checks sizes and rates, and that the path is long enough for its ramps.
/// @throws InvalidInput  naming the field, its value and the expected one
void validate(const SmoothPath& path, const std::string& where);

}  // namespace quadtune
