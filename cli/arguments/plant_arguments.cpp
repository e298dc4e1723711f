// SPDX-License-Identifier: Apache-2.0
#include "arguments/plant_arguments.hpp"

#include <fmt/format.h>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

namespace quadtune::cli {

void add_plant_options(CommandLine& line, PlantArguments& arguments) {
  line.add_option("V", arguments.vehicle, "a built-in vehicle's name or a vehicle file");
  line.add_option("--at", arguments.at, "steady flight: hover (default), line, circle or spin")
      ->type_name("FLIGHT");
  line.add_number("--speed", arguments.speed, "over the ground [m/s]; line and circle")
      ->type_name("V");
  line.add_number("--climb", arguments.climb, "upward [m/s]; line, circle and spin")
      ->type_name("V");
  line.add_number("--radius", arguments.radius, "of the circle [m]; negative turns left")
      ->type_name("R");
  line.add_number("--yaw-rate", arguments.yaw_rate,
                  "of a spin on the spot [rad/s]; negative turns left")
      ->type_name("RATE");
  line.add_number("--yaw", arguments.yaw, "heading from north, clockwise from above [rad]")
      ->type_name("ANGLE");
  line.add_option("--convention", arguments.convention, "ned (default), uquad or mambo")
      ->type_name("NAME");
  line.add_option("--inputs", arguments.inputs,
                  "rotor-speed (default), rotor-thrust, wrench or command")
      ->type_name("KIND");
  line.add_option("--states", arguments.states, "full (default), no-position or names")
      ->type_name("LIST");
}

LinearizeOptions linearize_options(const PlantArguments& arguments) {
  LinearizeOptions options;
  options.convention = arguments.convention;
  options.inputs = input_kind(arguments.inputs, "--inputs");
  options.states = state_selection(arguments.states, "--states");
  // Refused by the options' names, not by the function that would trip over them.
  (void)selected_states(convention(options.convention, "--convention"), options.states, "--states");
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
    throw UsageError("quadtune: --radius is missing or 0, expected that of the circle in metres",
                     "--radius");
  if (condition.kind == FlightKind::spin && condition.yaw_rate == 0)
    throw UsageError("quadtune: --yaw-rate is missing or 0, expected that of the spin in rad/s",
                     "--yaw-rate");
  const LinearizeOptions options = linearize_options(arguments);
  try {
    plant.model = linearize_or_refuse(plant.vehicle, condition, options, arguments.vehicle);
  } catch (const InvalidInput& error) {
    if (error.where() != "trim") throw;
    // A flight that there is not, such as one at a negative speed: the options are at fault.
    throw InvalidInput("--at " + arguments.at, error.message());
  }
  return plant;
}

bool asks_for_flown_plant(const std::string& plant, const std::string& verb) {
  if (plant == "flown") return true;
  if (plant == "ideal") return false;
  throw UsageError(
      fmt::format("quadtune {}: --plant is '{}', expected flown or ideal{}", verb,
                  internal::printable(plant), internal::did_you_mean(plant, {"flown", "ideal"})),
      "--plant");
}

}  // namespace quadtune::cli
