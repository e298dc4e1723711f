// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/flight_event.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

[[noreturn]] void refuse(const std::string& where, std::size_t index, const std::string& message) {
  throw InvalidInput(where, fmt::format("event {}: {}", index + 1, message));
}

}  // namespace

std::string describe(const FlightEvent& event) {
  if (const auto* fault = std::get_if<MotorFault>(&event.what)) {
    if (fault->thrust_share == 0) return fmt::format("motor {} stops", fault->motor);
    return fmt::format("motor {} keeps {} of its thrust", fault->motor, fault->thrust_share);
  }
  const double mass = std::get<LoadChange>(event.what).mass;
  return fmt::format("a load of {:.4g} kg is {}", std::abs(mass),
                     mass > 0 ? "picked up" : "dropped");
}

void validate(const std::vector<FlightEvent>& events, double duration, const std::string& where) {
  double before = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const FlightEvent& event = events[i];
    if (!(event.time >= 0 && event.time <= duration))
      refuse(where, i,
             fmt::format("its time is {} s, expected 0 to the mission's duration, {} s", event.time,
                         duration));
    if (event.time < before)
      refuse(where, i,
             fmt::format("its time is {} s, expected at least that of the event "
                         "before, {} s, because events must be in order",
                         event.time, before));
    before = event.time;
    if (const auto* fault = std::get_if<MotorFault>(&event.what)) {
      if (fault->motor < 1)
        refuse(where, i, fmt::format("its motor is {}, expected 1 or more", fault->motor));
      if (!(fault->thrust_share >= 0 && fault->thrust_share <= 1))
        refuse(where, i,
               fmt::format("its thrust share is {}, expected 0 (the motor stops) to 1",
                           fault->thrust_share));
    } else {
      const double mass = std::get<LoadChange>(event.what).mass;
      if (mass == 0 || !std::isfinite(mass))
        refuse(where, i,
               fmt::format("its load is {} kg, expected a nonzero number: positive for a "
                           "load that is picked up, negative for one that is dropped",
                           mass));
    }
  }
}

void require_possible(const std::vector<FlightEvent>& events, const Vehicle& vehicle,
                      const std::string& where) {
  double mass = vehicle.mass;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (const auto* fault = std::get_if<MotorFault>(&events[i].what)) {
      if (fault->motor > static_cast<int>(vehicle.rotors.size()))
        refuse(where, i,
               fmt::format("its motor is {}, expected 1 to {}, the motors of '{}'", fault->motor,
                           vehicle.rotors.size(), vehicle.name));
      continue;
    }
    const double load = std::get<LoadChange>(events[i].what).mass;
    mass += load;
    if (!(mass > 0))
      refuse(where, i,
             fmt::format("'{}' weighs {:.6g} kg after dropping {} kg, expected more than "
                         "0",
                         vehicle.name, mass, -load));
  }
}

}  // namespace quadtune
