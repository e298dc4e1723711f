// SPDX-License-Identifier: Apache-2.0
/// The steady flights about which a vehicle is linearized.
#pragma once

#include <string>

namespace quadtune {

/// The kind of steady flight: constant body velocity and rates, hence constant rotor speeds.
enum class FlightKind {
  hover,  ///< stationary
  line,   ///< straight, at `speed` over the ground and with `climb`
  /// Coordinated circle of `radius` at `speed`, with `climb` (a helix if climb ≠ 0).
  circle,
  /// Rotation in place at `yaw_rate`, with `climb`: a circle of radius 0.
  spin,
};

/// A steady flight, independent of any convention (yaw from north, clockwise seen from above).
struct FlightCondition {
  FlightKind kind = FlightKind::hover;  ///< which steady flight
  /// Heading of the body's x axis [rad]; in a circle, at the linearized instant.
  double yaw = 0;
  double speed = 0;   ///< horizontal ground speed along the heading [m/s], ≥ 0; line and circle
  double climb = 0;   ///< upward speed [m/s]; line, circle and spin
  double radius = 0;  ///< of the circle [m]; > 0 turns right (clockwise seen from above), < 0 left
  double yaw_rate = 0;  ///< of the heading [rad/s], > 0 clockwise seen from above; spin only
};

/// The steady flight along the heading for a ground speed, a climb speed and a yaw rate: a hover, a
/// line, a circle of radius speed/yaw_rate, or a spin.
/// @param speed     [m/s], ≥ 0;  @param climb  [m/s];  @param yaw_rate  [rad/s];  @param yaw  [rad]
[[nodiscard]] FlightCondition steady_flight(double speed, double climb, double yaw_rate,
                                            double yaw = 0);

/// "hover", "line", "circle" or "spin".
[[nodiscard]] std::string to_string(FlightKind kind);

/// @throws InvalidInput  with the unknown name and the four valid ones.
[[nodiscard]] FlightKind flight_kind(const std::string& name, const std::string& where);

}  // namespace quadtune
