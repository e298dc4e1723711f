// SPDX-License-Identifier: Apache-2.0
/// Numbers of a vehicle that no multirotor is likely to have: most often a unit was taken for
/// another.
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// One figure outside its plausible range.
struct Implausibility {
  std::string quantity;  ///< in words, e.g. "thrust-to-weight"
  std::string unit;      ///< "" of a ratio
  double value = 0;
  double low = 0;     ///< of the plausible range
  double high = 0;    ///< likewise
  std::string cause;  ///< the likely one, e.g. "max_rad_s is in rpm"
};

/// Holds the vehicle against what multirotors of 5 g to 50 kg have: arm against mass, principal
/// moments against mass times arm², thrust against weight, drag torque against thrust, rotor speed
/// at hover against the room for a propeller, motor lag, rotor inertia, environment, battery.
///
/// The ranges are wide: a factor of 100 is seen in each figure, a factor of 3 in none. A vehicle
/// may well be outside one; that is a reason to look, not an error.
/// @param vehicle  one that validate() accepts
/// Theory: "Plausible vehicles".
[[nodiscard]] std::vector<Implausibility> implausible(const Vehicle& vehicle);

/// "thrust-to-weight is 138.7, plausible is 1 to 10: max_rad_s may be in rpm".
[[nodiscard]] std::string to_string(const Implausibility& figure);

}  // namespace quadtune
