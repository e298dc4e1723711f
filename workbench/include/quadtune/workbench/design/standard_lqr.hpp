// SPDX-License-Identifier: Apache-2.0
/// The default LQR of a vehicle for which no weights are given.
#pragma once

#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/pid/pid_cascade.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// Weights by Bryson's rule from the capabilities of the vehicle, see docs/cli.md: diagonal, for
/// the 12 states of ned_convention() and the wrench.
[[nodiscard]] LqrWeights standard_weights(const CascadeVehicle& vehicle);

/// LQR at hover from the 12 states to the wrench with standard_weights(). The motor lag is not
/// modelled.
/// @param vehicle  from cascade_vehicle()
/// @param who      name of the caller, e.g. "fly", for the message of NoSolution
/// @throws NoSolution  with the culprit
[[nodiscard]] RiccatiResult standard_lqr(const CascadeVehicle& vehicle, const std::string& who);

/// The same as gains that can be flown.
[[nodiscard]] Gains standard_gains(const Vehicle& vehicle, const std::string& who);

}  // namespace quadtune
