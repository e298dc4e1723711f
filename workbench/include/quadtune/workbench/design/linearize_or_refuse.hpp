// SPDX-License-Identifier: Apache-2.0
/// The linear model of a vehicle in steady flight, or why there is none.
#pragma once

#include <string>

#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// A vehicle with its linear model in steady flight.
struct LinearVehicle {
  Vehicle vehicle;
  FlightCondition flight;
  Linearization model;
};

/// Trims and linearizes.
/// @param where  the file or vehicle that asked for it, for NoSolution
/// @throws NoSolution  with the trim's culprit
[[nodiscard]] Linearization linearize_or_refuse(const Vehicle& vehicle,
                                                const FlightCondition& condition,
                                                const LinearizeOptions& options,
                                                const std::string& where);

}  // namespace quadtune
