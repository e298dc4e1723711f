// SPDX-License-Identifier: Apache-2.0
/// Lines, circles and lemniscates that start and stop smoothly, with exact derivatives.
///
/// A path is a curve over a parameter s, and s follows one law in time: it stands until `begin`,
/// gathers speed over `ramp`, goes on at a constant rate, loses speed over `ramp` and stands. While
/// it gathers speed, u = (t - begin)/ramp in [0, 1],
///
///     s' = rate (6 u⁵ - 15 u⁴ + 10 u³),   s = rate ramp (u⁶ - 3 u⁵ + 5/2 u⁴)
///
/// and the end mirrors it, so that position, velocity, acceleration and jerk have no jump.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>

namespace quadtune {

/// Where the nose points on a path.
enum class Nose {
  fixed,  ///< always at the same yaw
  ahead,  ///< along the path, also while it stands at an end
};

/// How a path's parameter moves, and the yaw on the way.
struct Passage {
  double begin = 0;  ///< when it starts to move [s], ≥ 0
  double ramp = 1;   ///< how long it gathers speed, and how long it loses it [s], > 0
  Nose nose = Nose::fixed;
  double yaw = 0;  ///< of a fixed nose [rad]

  friend bool operator==(const Passage&, const Passage&) = default;
};

/// s = length from `from` to `to`.
struct LinePath {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< world [m]
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< world [m]; not `from`
  double speed = 0;                                ///< [m/s], > 0
  Passage passage;

  friend bool operator==(const LinePath&, const LinePath&) = default;
};

/// s = angle gone round: centre + |radius| (cos b, sin b, 0) at the bearing b = from ± s.
struct CirclePath {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< world [m]
  double radius = 0;   ///< [m], not 0; positive turns right (clockwise seen from above)
  double bearing = 0;  ///< of the first point, seen from the centre [rad]; 0 is north
  double speed = 0;    ///< [m/s], > 0
  double turns = 1;    ///< > 0
  Passage passage;

  friend bool operator==(const CirclePath&, const CirclePath&) = default;
};

/// Gerono's lemniscate, s = angle: a sin s along its long axis and b sin 2s to the right of it,
/// with 2 a = length, 2 b = width. It starts at the crossing; from tip to tip it is `length` long.
struct LemniscatePath {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< world [m]
  double length = 0;                                 ///< [m], > 0
  double width = 0;                                  ///< [m], > 0
  double heading = 0;                                ///< of the long axis [rad]
  double lap = 0;                                    ///< time of a lap at full rate [s], > 0
  double laps = 1;                                   ///< > 0
  Passage passage;

  friend bool operator==(const LemniscatePath&, const LemniscatePath&) = default;
};

using SmoothPath = std::variant<LinePath, CirclePath, LemniscatePath>;

/// A point that moves on a path, world axes north-east-down.
struct PathPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s²]
  double yaw = 0;                                          ///< [rad], without jumps
  double yaw_rate = 0;                                     ///< [rad/s]
};

/// The point at time t [s]; before its begin the first, after its end the last. Velocity,
/// acceleration and yaw rate are the exact derivatives of position and yaw.
[[nodiscard]] PathPoint path_point(const SmoothPath& path, double t);

/// When the point has stopped [s].
[[nodiscard]] double path_end(const SmoothPath& path);

/// Checks sizes, rates and that the path is long enough for its ramps.
/// @throws InvalidInput  naming the field, what came and what was expected.
void validate(const SmoothPath& path, const std::string& where);

}  // namespace quadtune
