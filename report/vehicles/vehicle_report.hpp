// SPDX-License-Identifier: Apache-2.0
/// A vehicle as text and as JSON: the values of its file, derived values, and assumptions.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"

namespace quadtune::report {

/// The keys of a vehicle file, "assumed", "warnings", and "derived" with the hover.
[[nodiscard]] internal::Json to_json(const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const Vehicle& vehicle);

/// The check of a vehicle that can hover: a line for each implausible value.
/// @param name  of the vehicle, as given by the user
[[nodiscard]] std::string to_text(const VehicleCheck& check, const std::string& name);

/// One line for each vehicle: name, mass and description.
[[nodiscard]] std::string vehicle_list(const std::vector<std::string>& names);

}  // namespace quadtune::report
