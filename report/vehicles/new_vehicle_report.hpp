// SPDX-License-Identifier: Apache-2.0
/// What of a new vehicle's file was estimated.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/vehicle/new_vehicle.hpp"

namespace quadtune::report {

/// One line for each estimate: what, by which rule, how uncertain, and how to measure it.
[[nodiscard]] std::vector<std::string> estimate_notes(const NewVehicle& made);

/// "file", the text of the vehicle file; "name"; "spread"; "estimates" as rows.
[[nodiscard]] internal::Json new_vehicle_json(const NewVehicle& made);

}  // namespace quadtune::report
