// SPDX-License-Identifier: Apache-2.0
/// Events in a flight: a motor fails or weakens, the payload changes.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// A rotor loses part of its thrust and drag torque. With a share of 0 its motor stops for good.
struct MotorFault {
  int motor = 1;            ///< numbered from 1
  double thrust_share = 0;  ///< remaining fraction of its thrust before the event, 0 … 1

  friend bool operator==(const MotorFault&, const MotorFault&) = default;
};

/// The vehicle picks up or drops a load at its centre of mass. Inertia and centre of mass do not
/// change.
struct LoadChange {
  double mass = 0;  ///< [kg], not 0; negative: dropped

  friend bool operator==(const LoadChange&, const LoadChange&) = default;
};

/// An event. It takes effect in the first control period that begins at or after its time. Law and
/// estimator are not informed.
struct FlightEvent {
  double time = 0;                            ///< since the start of the mission [s], ≥ 0
  std::variant<MotorFault, LoadChange> what;  ///< the event

  friend bool operator==(const FlightEvent&, const FlightEvent&) = default;
};

/// "motor 2 stops", "motor 2 keeps 0.7 of its thrust", "a load of 0.1 kg is picked up".
[[nodiscard]] std::string describe(const FlightEvent& event);

/// Checks events independently of a vehicle: times in order and within the duration, shares and
/// masses in range.
/// @throws InvalidInput  naming the event, its value and the expected one
void validate(const std::vector<FlightEvent>& events, double duration, const std::string& where);

/// Checks that the vehicle has the motors, and that its mass remains positive through all events.
/// @throws InvalidInput  naming the event, its value and the expected one
void require_possible(const std::vector<FlightEvent>& events, const Vehicle& vehicle,
                      const std::string& where);

}  // namespace quadtune
