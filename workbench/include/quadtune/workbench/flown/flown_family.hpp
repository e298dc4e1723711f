// SPDX-License-Identifier: Apache-2.0
/// The flown plants of one vehicle for which a law is designed: at several heights, and with lower
/// and higher mass and shorter and longer motor lag than its file states.
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/flown_plant.hpp"

namespace quadtune {

/// One variant of the vehicle, with its flown plant.
struct FlownFamilyMember {
  std::string name;     ///< e.g. "at 3 m", "20 % lighter, lag 40 % longer"
  double height = 1.1;  ///< of the hover [m]
  double mass = 1;      ///< factors on the values of the vehicle file
  double lag = 1;       ///< factor on the motor lags
  bool nominal = true;  ///< both factors are 1
  FlownPlant plant;     ///< with the member's mass, lag and height
};

/// The largest factor on the mass of a member.
inline constexpr double kHeaviest = 1.2;

/// Why the vehicle with kHeaviest times its mass cannot hover, so that it has no family; empty if it
/// can.
[[nodiscard]] std::string why_no_reserve(Vehicle vehicle);

/// The members, with the vehicle's own sensors. Heights differ only if the estimator uses a sensor
/// that depends on the height.
/// @param vehicle    valid
/// @param inputs     quantities that the law commands
/// @param dt         control period of the law [s]
/// @param estimator  as FlightOptions::estimator; empty: the vehicle's usual one
/// @throws InvalidInput  as flown_plant()
/// @throws OptionError   if the estimator is unknown
/// @throws NoSolution    if a member cannot hover
[[nodiscard]] std::vector<FlownFamilyMember> flown_family(const Vehicle& vehicle, InputKind inputs,
                                                          double dt,
                                                          const std::string& estimator = "");

}  // namespace quadtune
