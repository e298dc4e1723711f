// SPDX-License-Identifier: Apache-2.0
/// Options that name a vehicle, its steady flight and how its linear model is written.
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

/// How the model is to be written.
/// @throws InvalidInput  naming the option, what came and what was expected.
[[nodiscard]] LinearizeOptions linearize_options(const PlantArguments& arguments);

/// The steady flight.
/// @throws InvalidInput  for another word than those of --at
[[nodiscard]] FlightCondition flight_condition(const PlantArguments& arguments);

/// Trims and linearizes.
/// @throws NoSolution  with the trim's culprit.
[[nodiscard]] LinearVehicle make_plant(const PlantArguments& arguments);

/// Whether an option --plant asks for the flown plant: "flown", not "ideal".
/// @param verb  for the message, e.g. "margins"
/// @throws UsageError  for another word
[[nodiscard]] bool asks_for_flown_plant(const std::string& plant, const std::string& verb);

}  // namespace quadtune::cli
