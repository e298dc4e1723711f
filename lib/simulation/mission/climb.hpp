// SPDX-License-Identifier: Apache-2.0
/// The reference of a take-off under the control law: a climb with limited speed and acceleration.
#pragma once

namespace quadtune {

/// Acceleration at the beginning of the climb and deceleration at its end [m/s²].
inline constexpr double kClimbAcceleration = 1;

/// Duration of a climb of `height` [m], ≥ 0, with at most `rate` [m/s], > 0. [s]
[[nodiscard]] double climb_duration(double height, double rate);

struct ClimbPoint {
  double height = 0;  ///< above the ground [m]
  double speed = 0;   ///< upward [m/s]
};

/// Where such a climb is t seconds after its beginning. The speed is continuous: a trapezoid over
/// time, or a triangle for a climb too short to reach the rate. Before it begins it is on the
/// ground; after its end it stays at its height.
[[nodiscard]] ClimbPoint climb_at(double height, double rate, double t);

}  // namespace quadtune
