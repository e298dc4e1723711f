// SPDX-License-Identifier: Apache-2.0
/// The linear model of a vehicle at a trim, or the reason why there is none.
#pragma once

#include <string>

#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// A vehicle with its linear model at a trim.
struct LinearVehicle {
  Vehicle vehicle;         ///< that was linearized
  FlightCondition flight;  ///< the trim
  Linearization model;     ///< solved
};

/// Trims and linearizes.
/// @param vehicle    valid
/// @param condition  the trim
/// @param options    states, inputs and convention of the model
/// @param where      file or vehicle, for the message of NoSolution
/// @throws NoSolution  with the trim's culprit
[[nodiscard]] Linearization linearize_or_refuse(const Vehicle& vehicle,
                                                const FlightCondition& condition,
                                                const LinearizeOptions& options,
                                                const std::string& where);

}  // namespace quadtune
