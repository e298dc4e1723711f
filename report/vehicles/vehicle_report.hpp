// SPDX-License-Identifier: Apache-2.0
/// A vehicle as text and as JSON: what its file says, what follows from it, and what is assumed.
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

/// A vehicle that can hover, and a line for each figure that is not plausible.
/// @param name  as it was checked
[[nodiscard]] std::string to_text(const VehicleCheck& check, const std::string& name);

/// One line for each vehicle: name, mass and description.
[[nodiscard]] std::string vehicle_list(const std::vector<std::string>& names);

}  // namespace quadtune::report
