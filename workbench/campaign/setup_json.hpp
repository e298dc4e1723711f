// SPDX-License-Identifier: Apache-2.0
/// What decides a flight beside its vehicle, mission and law, as JSON and back to the same bits.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune::internal {

/// Every field of the setup but `vehicle`, `flown`, `mission` (except its limits, settling rule and
/// take-off), `controller`, `general_filter`, `seed`, `flight` and `log`.
[[nodiscard]] Json setup_to_json(const FlightSetup& setup);

/// Reads them back.
/// @param setup  has the vehicle, mission, controller and general filter already
/// @param where  for messages
/// @throws InvalidInput, JsonError  for anything that setup_to_json() does not write
void setup_from_json(const Json& json, const std::string& where, FlightSetup& setup);

}  // namespace quadtune::internal
