// SPDX-License-Identifier: Apache-2.0
/// Physical quantities as a person writes them, with their unit: "1240g", "225 mm", "5200rpm".
#pragma once

#include <string>

namespace quadtune {

/// What a quantity measures. The SI unit of the result is in brackets.
enum class QuantityUnit {
  mass,         ///< g, kg, oz, lb [kg]
  length,       ///< mm, cm, m, in [m]
  force,        ///< N, gf, kgf [N], with 1 gf = 9.80665e-3 N
  rotor_speed,  ///< rpm, rad/s, Hz [rad/s]
  duration,     ///< ms, s [s]
  inertia,      ///< kgm2, gm2, gcm2, gmm2 [kg m²]; exponents also as ^2 or ²
};

/// Reads a number followed by a unit, with or without blanks between them. A unit is required,
/// because 1.2 may be kilograms or pounds.
/// @param text  number and unit
/// @param unit  the kind of quantity, which determines the units
/// @param key   of the option, for messages, e.g. "mass"
/// @return      the value in SI units, > 0
/// @throws OptionError  "mass is '1.2', expected a number with a unit: g, kg, oz or lb"
[[nodiscard]] double read_quantity(const std::string& text, QuantityUnit unit,
                                   const std::string& key);

}  // namespace quadtune
