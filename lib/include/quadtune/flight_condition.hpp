// SPDX-License-Identifier: Apache-2.0
/// The steady flights about which a vehicle is linearized.
#pragma once

#include <string>

namespace quadtune {

/// Which steady flight: constant body velocity and rates, hence constant rotor speeds.
enum class FlightKind {
  hover,   ///< at rest
  line,    ///< straight, at `speed` over the ground and `climb`
  circle,  ///< coordinated circle of `radius` at `speed` and `climb` (a helix if climb ≠ 0)
};

/// A steady flight, in the vehicle-neutral sense (yaw from north, clockwise seen from above).
struct FlightCondition {
  FlightKind kind = FlightKind::hover;
  double yaw = 0;    ///< heading of the body's x axis [rad]; in a circle, at the linearized instant
  double speed = 0;  ///< horizontal ground speed along the heading [m/s], ≥ 0; line and circle
  double climb = 0;  ///< upward speed [m/s]; line and circle
  double radius = 0;  ///< of the circle [m]; > 0 turns right (clockwise seen from above), < 0 left
};

/// "hover", "line" or "circle".
[[nodiscard]] std::string to_string(FlightKind kind);

/// @throws InvalidInput  naming the word and the three that exist.
[[nodiscard]] FlightKind flight_kind(const std::string& name, const std::string& where);

}  // namespace quadtune
