// SPDX-License-Identifier: Apache-2.0
/// Options that select a vehicle, its steady flight and the form of its linear model.
#pragma once

#include <string>

#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

namespace quadtune::cli {

class CommandLine;

struct PlantArguments {
  std::string vehicle;
  std::string at = "hover";
  double speed = 0;     // [m/s]
  double climb = 0;     // [m/s]
  double radius = 0;    // [m]
  double yaw_rate = 0;  // [rad/s]
  double yaw = 0;       // [rad]
  std::string convention = "ned";
  std::string inputs = "rotor-speed";
  std::string states = "full";
};

/// Adds V and --at, --speed, --climb, --radius, --yaw-rate, --yaw, --convention, --inputs,
/// --states.
void add_plant_options(CommandLine& line, PlantArguments& arguments);

/// The convention, inputs and states of the linear model.
/// @throws InvalidInput  naming the option, its value and what was expected.
[[nodiscard]] LinearizeOptions linearize_options(const PlantArguments& arguments);

/// The steady flight.
/// @throws InvalidInput  if the value of --at is unknown
[[nodiscard]] FlightCondition flight_condition(const PlantArguments& arguments);

/// Trims and linearizes.
/// @throws NoSolution  if no trim exists; the message names the reason.
[[nodiscard]] LinearVehicle make_plant(const PlantArguments& arguments);

}  // namespace quadtune::cli
