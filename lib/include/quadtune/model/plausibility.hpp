// SPDX-License-Identifier: Apache-2.0
/// Values of a vehicle that are implausible for a multirotor, most often because of a wrong unit.
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// One quantity outside its plausible range.
struct Implausibility {
  std::string quantity;  ///< in words, e.g. "thrust-to-weight"
  std::string unit;      ///< empty for a ratio
  double value = 0;      ///< value of the vehicle [unit]
  double low = 0;        ///< lower end of the plausible range
  double high = 0;       ///< upper end
  std::string cause;     ///< the likely cause, e.g. "max_rad_s is in rpm"
};

/// Compares the vehicle with multirotors of 5 g to 50 kg: arm length relative to mass, principal
/// moments to mass times arm², thrust to weight, drag torque to thrust, hover speed to the space
/// for a propeller; also motor lag, rotor inertia, environment and battery.
///
/// The ranges are wide: a factor of 100 is detected in every quantity, a factor of 3 in none. A
/// valid vehicle may be outside a range, so this is a hint and not an error.
/// @param vehicle  accepted by validate()
/// Theory: "Plausible vehicles".
[[nodiscard]] std::vector<Implausibility> find_implausible_values(const Vehicle& vehicle);

/// "thrust-to-weight is 138.7, plausible is 1 to 10: max_rad_s seems to be in rpm".
[[nodiscard]] std::string to_string(const Implausibility& figure);

}  // namespace quadtune
