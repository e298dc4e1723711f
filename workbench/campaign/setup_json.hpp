// SPDX-License-Identifier: Apache-2.0
/// The settings of a flight, except vehicle, mission and law, as JSON; exact to the bit.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune::internal {

/// All fields of the setup except `vehicle`, `flown`, `mission` (except its limits, settling rule
/// and
/// take-off), `controller`, `general_filter`, `seed`, `flight` and `log`.
[[nodiscard]] Json setup_to_json(const FlightSetup& setup);

/// The inverse of setup_to_json().
/// @param setup  already has the vehicle, mission, controller and general filter
/// @param where  for messages
/// @throws InvalidInput, JsonError  if the JSON is not an output of setup_to_json()
void setup_from_json(const Json& json, const std::string& where, FlightSetup& setup);

}  // namespace quadtune::internal
