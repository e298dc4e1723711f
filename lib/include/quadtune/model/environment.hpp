// SPDX-License-Identifier: Apache-2.0
/// What surrounds a flight: air, wind, gravity, the earth's magnetic field and the ground.
#pragma once

#include <Eigen/Core>
#include <string>

#include "quadtune/model/atmosphere.hpp"

namespace quadtune {

/// One push of wind in the shape (1 - cos), along one direction.
struct Gust {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< at its strongest, world axes [m/s]
  double start = 0;                                    ///< [s]
  double length = 1;                                   ///< from nothing to nothing [s], > 0
};

/// Wind in world axes: mean + gust + turbulence.
struct Wind {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< of the air over the ground [m/s]
  Gust gust;
  /// Wind speed at 6 m that drives the turbulence [m/s]: 7.7 light, 15.4 moderate, 23.2 severe.
  double turbulence = 0;
  double turbulence_height = 6;  ///< for which its scales are taken [m], 3 … 300
};

/// "calm", "light", "moderate", "severe" or a list like "north=3, gust_east=2, gust_at=5".
/// @throws InvalidInput  naming what came
[[nodiscard]] Wind wind_of_words(const std::string& words, const std::string& where);

/// Static: the same everywhere. Dynamic: air, gravity and field change with height.
struct Environment {
  bool dynamic = false;
  double ground_height = 0;  ///< of the world's origin above mean sea level [m]; dynamic only
  /// World axes [µT]; the world's own value for middle latitudes where nothing is said.
  Eigen::Vector3d magnetic_field = {20, 0, 43};
  Wind wind;
};

/// Radius of the earth by which gravity falls off with height [m] (ISO 2533).
inline constexpr double kEarthRadius = 6356766;

}  // namespace quadtune
