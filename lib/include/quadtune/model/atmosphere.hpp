// SPDX-License-Identifier: Apache-2.0
/// The air that a vehicle flies in: uniform, or the International Standard Atmosphere.
#pragma once

namespace quadtune {

/// State of the air at one place.
struct Air {
  double temperature = 288.15;      ///< [K]
  double pressure = 101325;         ///< [Pa]
  double density = 1.225;           ///< [kg/m³]
  double speed_of_sound = 340.294;  ///< [m/s]
};

/// Range of the standard atmosphere, geopotential height above mean sea level [m].
inline constexpr double kStandardAtmosphereFloor = -2000;
inline constexpr double kStandardAtmosphereCeiling = 20000;  ///< upper end of that range [m]

/// International Standard Atmosphere: -6.5 K/km up to 11 km, 216.65 K from there to 20 km.
/// @param height  Geopotential height above mean sea level [m], -2000 ≤ height ≤ 20000.
/// @throws InvalidInput  outside the range or not finite.
/// Source: ISO 2533:1975, ICAO Doc 7488.
[[nodiscard]] Air standard_atmosphere(double height);

/// Air of the given density at the standard sea-level temperature.
/// @param density  [kg/m³], > 0.
/// @throws InvalidInput  if density is not positive and finite.
[[nodiscard]] Air air_of_density(double density);

/// Selects the model of the air.
enum class AtmosphereModel {
  still,     ///< uniform
  standard,  ///< varies with height
};

/// The air as a function of height.
struct Atmosphere {
  AtmosphereModel model = AtmosphereModel::still;  ///< uniform air, or the standard atmosphere
  Air air;                                         ///< uniform air, used by AtmosphereModel::still
  /// Height of the world's origin above mean sea level [m], used by AtmosphereModel::standard.
  double ground_height = 0;

  /// @param height  above the world's origin [m], that is -pz.
  /// @throws InvalidInput  as standard_atmosphere(), for AtmosphereModel::standard only
  [[nodiscard]] Air at(double height) const;
};

}  // namespace quadtune
