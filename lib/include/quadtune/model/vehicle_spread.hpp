// SPDX-License-Identifier: Apache-2.0
/// How uncertain the numbers of a vehicle file are, as its table [spread] states.
#pragma once

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Relative half widths of the intervals that contain the true values with a probability of 95 %:
/// 0.2 means 0.8 to 1.2 times the file's value. 0: the file states no uncertainty.
struct VehicleSpread {
  double mass = 0;       ///< of the total mass
  double inertia = 0;    ///< of each principal moment of inertia
  double thrust = 0;     ///< of the thrust and drag torque of all rotors at a given speed
  double motor_lag = 0;  ///< of the time constants of the motors

  /// Whether the file states any uncertainty.
  [[nodiscard]] bool stated() const {
    return mass > 0 || inertia > 0 || thrust > 0 || motor_lag > 0;
  }
  friend bool operator==(const VehicleSpread&, const VehicleSpread&) = default;
};

/// Largest half width that a file may state.
inline constexpr double kMaxSpread = 0.9;

/// The table [spread] of the file that a vehicle was read from; all zero without one, and for a
/// vehicle that was made in memory.
/// @param vehicle  as load_vehicle() or parse_vehicle() returned it; `text` is what is read
[[nodiscard]] VehicleSpread spread_of(const Vehicle& vehicle);

}  // namespace quadtune
