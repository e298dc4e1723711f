// SPDX-License-Identifier: Apache-2.0
#include "plants.hpp"

#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::python {

LinearVehicle make_plant(const PlantWords& words) {
  LinearVehicle plant;
  plant.vehicle = load_vehicle(words.vehicle);
  plant.flight = {flight_kind(words.at, "at"),
                  words.yaw,
                  words.speed,
                  words.climb,
                  words.radius,
                  words.yaw_rate};
  if (plant.flight.kind == FlightKind::circle && words.radius == 0)
    throw OptionError("radius", "radius is missing or 0, expected that of the circle in metres");
  if (plant.flight.kind == FlightKind::spin && words.yaw_rate == 0)
    throw OptionError("yaw_rate", "yaw_rate is missing or 0, expected that of the spin in rad/s");
  LinearizeOptions options;
  const Convention& convention = named_convention(words.convention, "convention");
  options.convention = convention.name;
  options.inputs = input_kind(words.inputs, "inputs");
  options.states = state_selection(words.states, "states");
  (void)selected_states(convention, options.states, "states");  // refused by the argument's name
  try {
    plant.model = linearize_or_refuse(plant.vehicle, plant.flight, options, words.vehicle);
  } catch (const InvalidInput& error) {
    if (error.where() != "trim") throw;
    throw InvalidInput("at=" + words.at, error.message());
  }
  return plant;
}

}  // namespace quadtune::python
