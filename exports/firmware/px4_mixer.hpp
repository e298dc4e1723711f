// SPDX-License-Identifier: Apache-2.0
/// PX4's control allocation: the motor commands for a unit of each output.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "firmware/firmware_parts.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::exports {

/// The order in which PX4 numbers the rotors of a vehicle: for a quadrotor in X front right, back
/// left, front left, back right; otherwise as in the vehicle.
/// @return  indices into vehicle.rotors
[[nodiscard]] std::vector<std::size_t> px4_order(const Vehicle& vehicle);

/// Whether there are four rotors, one in each quadrant.
[[nodiscard]] bool px4_is_x(const Vehicle& vehicle);
/// Ratio of drag torque to thrust, from the coefficients of the squared speed, which dominate [m].
[[nodiscard]] double px4_torque_ratio(const Rotor& rotor);

/// (n × 3) commands per unit of roll, pitch and yaw output, rows in the vehicle's order: the
/// pseudo-inverse of the geometry in CA_ROTOR*, or of the vehicle's own if the values do not define
/// it, with its columns scaled as in PX4.
/// @throws InvalidInput  if the number of rotors differs, or the geometry cannot produce all
///                       torques
[[nodiscard]] Eigen::MatrixXd px4_mix(const Vehicle& vehicle, const ParameterValues& value);

}  // namespace quadtune::exports
