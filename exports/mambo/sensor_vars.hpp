// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "quadtune/model/vehicle.hpp"

namespace quadtune::exports {

/// The text of sensorsVars.m: rates, delays, biases and noises of the vehicle's sensors.
[[nodiscard]] std::string sensor_vars(const Vehicle& vehicle);

}  // namespace quadtune::exports
