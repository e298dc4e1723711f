// SPDX-License-Identifier: Apache-2.0
#include "arguments/plant_arguments.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {

void add_plant_options(CommandLine& line, PlantArguments& arguments) {
  line.add_option("V", arguments.vehicle, "a built-in vehicle's name or a vehicle file");
  line.add_option("--at FLIGHT", arguments.at,
                  "steady flight: hover (default), line, circle or spin");
  line.add_number("--speed SPEED", arguments.speed, "ground speed of line and circle [m/s]");
  line.add_number("--climb RATE", arguments.climb,
                  "climb rate of line, circle and spin, positive upward [m/s]");
  line.add_number("--radius R", arguments.radius,
                  "radius of the circle [m]; negative: turn to the left");
  line.add_number("--yaw-rate RATE", arguments.yaw_rate,
                  "yaw rate of a spin on the spot [rad/s]; negative: turn to the left");
  line.add_number("--yaw ANGLE", arguments.yaw, "heading from north, clockwise from above [rad]");
  line.add_option("--convention NAME", arguments.convention,
                  "ned (default), uquad, mambo or a convention file");
  line.add_option("--inputs KIND", arguments.inputs,
                  "rotor-speed (default), rotor-thrust, wrench or command");
  line.add_option("--states LIST", arguments.states,
                  "full (default), no-position or a list of names");
}

LinearizeOptions linearize_options(const PlantArguments& arguments) {
  LinearizeOptions options;
  const Convention& words = named_convention(arguments.convention, "--convention");
  options.convention = words.name;
  options.inputs = input_kind(arguments.inputs, "--inputs");
  options.states = state_selection(arguments.states, "--states");
  // Validated here, so that the message names the option.
  (void)selected_states(words, options.states, "--states");
  return options;
}

FlightCondition flight_condition(const PlantArguments& arguments) {
  return {flight_kind(arguments.at, "--at"),
          arguments.yaw,
          arguments.speed,
          arguments.climb,
          arguments.radius,
          arguments.yaw_rate};
}

LinearVehicle make_plant(const PlantArguments& arguments) {
  LinearVehicle plant;
  plant.vehicle = load_vehicle(arguments.vehicle);
  plant.flight = flight_condition(arguments);
  const FlightCondition& condition = plant.flight;
  if (condition.kind == FlightKind::circle && condition.radius == 0)
    refuse("--radius", "--at circle requires --radius, the radius of the circle in metres, not 0");
  if (condition.kind == FlightKind::circle && condition.speed == 0)
    refuse("--speed", "--at circle requires --speed, a positive ground speed in m/s");
  if (condition.kind == FlightKind::spin && condition.yaw_rate == 0)
    refuse("--yaw-rate", "--at spin requires --yaw-rate, the yaw rate of the spin in rad/s, not 0");
  const LinearizeOptions options = linearize_options(arguments);
  try {
    plant.model = linearize_or_refuse(plant.vehicle, condition, options, arguments.vehicle);
  } catch (const InvalidInput& error) {
    if (error.where() != "trim") throw;
    // The flight itself is invalid, e.g. its speed is negative, so the options are the cause.
    refuse("--at " + arguments.at, "--at {}: {}", arguments.at, error.message());
  }
  if (condition.kind == FlightKind::line && condition.speed == 0 && condition.climb == 0)
    plant.model.notes.emplace_back("--at line without --speed and --climb is a hover");
  if (std::abs(arguments.yaw) > 2 * std::numbers::pi)
    plant.model.notes.push_back(fmt::format("--yaw is {} rad, which is {:.3g} degrees",
                                            number(arguments.yaw),
                                            arguments.yaw * 180 / std::numbers::pi));
  return plant;
}

}  // namespace quadtune::cli
