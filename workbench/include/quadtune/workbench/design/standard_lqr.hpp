// SPDX-License-Identifier: Apache-2.0
/// The LQR that stands for a vehicle whose user has not given any weights.
#pragma once

#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/pid_cascade.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// Weights by Bryson's rule from what the vehicle can give, see docs/cli.md: diagonal, of the 12
/// states of ned_convention() and the wrench.
[[nodiscard]] LqrWeights standard_weights(const CascadeVehicle& vehicle);

/// Of the hover, from the 12 states to the wrench, weights by Bryson's rule from what the vehicle
/// can give, see docs/cli.md. The motors' lag is not in it.
/// @param who  asked, e.g. "fly", for the message of NoSolution
/// @throws NoSolution  with the culprit
[[nodiscard]] RiccatiResult standard_lqr(const CascadeVehicle& vehicle, const std::string& who);

/// The same as gains that can be flown.
[[nodiscard]] Gains standard_gains(const Vehicle& vehicle, const std::string& who);

}  // namespace quadtune
