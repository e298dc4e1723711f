// SPDX-License-Identifier: Apache-2.0
#include "plants.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune::python {

FlightCondition flight_condition(const PlantWords& words) {
  return {flight_kind(words.at, "at"),
          words.yaw,
          words.speed,
          words.climb,
          words.radius,
          words.yaw_rate};
}

LinearizeOptions linearize_options(const PlantWords& words) {
  LinearizeOptions options;
  const Convention& convention = named_convention(words.convention, "convention");
  options.convention = convention.name;
  options.inputs = input_kind(words.inputs, "inputs");
  options.states = state_selection(words.states, "states");
  (void)selected_states(convention, options.states, "states");  // refused by the argument's name
  return options;
}

LinearVehicle make_plant(const PlantWords& words) {
  LinearVehicle plant;
  plant.vehicle = load_vehicle(words.vehicle);
  plant.flight = flight_condition(words);
  if (plant.flight.kind == FlightKind::circle && words.radius == 0)
    throw OptionError("radius", "radius is missing or 0, expected that of the circle in metres");
  if (plant.flight.kind == FlightKind::spin && words.yaw_rate == 0)
    throw OptionError("yaw_rate", "yaw_rate is missing or 0, expected that of the spin in rad/s");
  const LinearizeOptions options = linearize_options(words);
  try {
    plant.model = linearize_or_refuse(plant.vehicle, plant.flight, options, words.vehicle);
  } catch (const InvalidInput& error) {
    if (error.where() != "trim") throw;
    throw InvalidInput("at=" + words.at, error.message());
  }
  return plant;
}

std::vector<std::string> listed(const std::optional<Names>& names) {
  if (!names) return {};
  const bool none = names->list.size() == 1 && names->list.front() == "none";
  return none ? std::vector<std::string>() : names->list;
}

std::vector<std::string> with_integrals(std::vector<std::string> states,
                                        const std::vector<std::string>& integrals) {
  for (const std::string& name : integrals) states.push_back("int_" + name);
  return states;
}

LqrDesign lqr_design(const LqrWords& words, const PlantWords& plant,
                     const std::vector<Signal>& states, const std::vector<Signal>& inputs) {
  LqrDesign design;
  design.convention = named_convention(plant.convention, "convention").name;
  design.input_kind = input_kind(plant.inputs, "inputs");
  design.method = lqr_method(words.method, "method");
  if (design.method != LqrMethod::continuous && !words.dt)
    throw OptionError("dt", fmt::format("dt is missing, expected a sample period with method '{}'",
                                        words.method));
  if (words.dt) require_positive(*words.dt, "dt", "seconds");
  design.dt = words.dt.value_or(0);
  design.states = names_or_numbers(states, std::ssize(states));
  design.inputs = names_or_numbers(inputs, std::ssize(inputs));
  design.integrals = words.integrals;
  const auto joined = [](const std::vector<std::string>& names) {
    return internal::joined(names, " ");
  };
  for (const std::string& name : design.integrals) {
    if (std::find(design.states.begin(), design.states.end(), name) == design.states.end())
      throw OptionError(
          "integral",
          fmt::format("integral: unknown state '{}'; expected names from {}{}", name,
                      joined(design.states), internal::did_you_mean(name, design.states)));
    if (std::count(design.integrals.begin(), design.integrals.end(), name) > 1)
      throw OptionError("integral",
                        fmt::format("integral: state '{}' is listed twice; expected once", name));
  }
  const Numbers ones{Eigen::VectorXd::Ones(1)};
  const std::vector<std::string> weighted = with_integrals(design.states, design.integrals);
  const Eigen::VectorXd Q =
      weights(words.Q.value_or(ones), weighted.size(), "Q", "states: " + joined(weighted));
  const auto nx = static_cast<Eigen::Index>(design.states.size());
  design.Q = Q.head(nx).asDiagonal();
  design.Q_integral = Q.tail(Q.size() - nx).asDiagonal();
  design.R =
      weights(words.R.value_or(ones), design.inputs.size(), "R", "inputs: " + joined(design.inputs))
          .asDiagonal();
  return design;
}

}  // namespace quadtune::python
