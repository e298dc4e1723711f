// SPDX-License-Identifier: Apache-2.0
/// What happens to a vehicle in flight: a motor that fails or weakens, a load that comes or goes.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// A rotor loses thrust, and drag torque with it. With a share of 0 its motor stops for good.
struct MotorFault {
  int motor = 1;            ///< 1 is the first
  double thrust_share = 0;  ///< of the thrust that it gave until then, 0 … 1

  friend bool operator==(const MotorFault&, const MotorFault&) = default;
};

/// The vehicle picks up a load at its centre of mass, or drops one. Inertia and centre of mass
/// stay.
struct LoadChange {
  double mass = 0;  ///< [kg], not 0; negative: dropped

  friend bool operator==(const LoadChange&, const LoadChange&) = default;
};

/// One event. It happens in the first control period that begins at its time or later; neither law
/// nor estimator is told.
struct FlightEvent {
  double time = 0;  ///< from the mission's start [s], ≥ 0
  std::variant<MotorFault, LoadChange> what;

  friend bool operator==(const FlightEvent&, const FlightEvent&) = default;
};

/// "motor 2 stops", "motor 2 keeps 0.7 of its thrust", "a load of 0.1 kg is picked up".
[[nodiscard]] std::string in_words(const FlightEvent& event);

/// Checks events on their own: times in order within the duration, shares and masses in range.
/// @throws InvalidInput  naming the event, what came and what was expected.
void validate(const std::vector<FlightEvent>& events, double duration, const std::string& where);

/// Checks that a vehicle has the motors and keeps a mass through all events.
/// @throws InvalidInput  naming the event, what came and what was expected.
void require_possible(const std::vector<FlightEvent>& events, const Vehicle& vehicle,
                      const std::string& where);

}  // namespace quadtune
