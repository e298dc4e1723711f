// SPDX-License-Identifier: Apache-2.0
/// The sensors of a vehicle in words.
#pragma once

#include <string>

#include "quadtune/model/vehicle.hpp"

namespace quadtune::report {

/// One sensor a line: rate, noise and faults, without its place on the vehicle; "none" without
/// sensors.
[[nodiscard]] std::string sensors_text(const Vehicle& vehicle);

}  // namespace quadtune::report
