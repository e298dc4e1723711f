// SPDX-License-Identifier: Apache-2.0
/// The reference of a take-off under the control law: a climb with limited speed and acceleration.
#pragma once

namespace quadtune {

/// Acceleration at the beginning of the climb and deceleration at its end [m/s²].
inline constexpr double kClimbAcceleration = 1;

/// Duration [s] of a climb of `height` [m], ≥ 0, with at most `rate` [m/s], > 0.
[[nodiscard]] double climb_duration(double height, double rate);

struct ClimbPoint {
  double height = 0;  ///< above the ground [m]
  double speed = 0;   ///< upward [m/s]
};

/// Height and speed t seconds after the beginning of a climb. The speed is continuous: a trapezoid
/// over time, or a triangle if the climb is too short to reach the rate. Before the beginning the
/// point is on the ground; after the end it stays at the final height.
[[nodiscard]] ClimbPoint climb_at(double height, double rate, double t);

}  // namespace quadtune
