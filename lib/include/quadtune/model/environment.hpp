// SPDX-License-Identifier: Apache-2.0
/// The surroundings of a flight: air, wind, gravity, magnetic field and ground.
#pragma once

#include <Eigen/Core>
#include <string>

#include "quadtune/model/atmosphere.hpp"

namespace quadtune {

/// A discrete gust of the shape (1 - cos) along one direction.
struct Gust {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< peak velocity, world axes [m/s]
  double start = 0;                                    ///< [s]
  double length = 1;                                   ///< duration from zero to zero [s], > 0
};

/// Wind in world axes: mean + gust + turbulence.
struct Wind {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< of the air over the ground [m/s]
  Gust gust;                                       ///< added to the mean while it lasts
  /// Wind speed at 6 m that drives the turbulence [m/s]: 7.7 light, 15.4 moderate, 23.2 severe.
  double turbulence = 0;
  double turbulence_height = 6;  ///< height at which its length scales are evaluated [m], 3 … 300
};

/// Parses "calm", "light", "moderate", "severe" or a list like "north=3, gust_east=2, gust_at=5".
/// A strength sets Wind::turbulence and, to the same speed, the north component of Wind::mean.
/// Keys: north, east, down, gust_north, gust_east, gust_down [m/s], towards which the air moves;
/// turbulence [m/s], gust_at, gust_length [s], turbulence_height [m].
/// @throws InvalidInput  for another word, a key that is given twice, or a value out of range: mean
///                       and gust at most 100 m/s, turbulence 0 to 100 m/s, height 3 to 300 m
[[nodiscard]] Wind parse_wind(const std::string& words, const std::string& where);

/// Static: uniform. Dynamic: air density, gravity and magnetic field vary with height.
struct Environment {
  bool dynamic = false;      ///< whether they vary with height
  double ground_height = 0;  ///< of the world's origin above mean sea level [m]; dynamic only
  /// World axes [µT]; the default is typical of middle latitudes.
  Eigen::Vector3d magnetic_field = {20, 0, 43};
  Wind wind;  ///< none by default
};

/// Earth radius for the decrease of gravity with height [m] (ISO 2533).
inline constexpr double kEarthRadius = 6356766;

}  // namespace quadtune
