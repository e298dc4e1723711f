// SPDX-License-Identifier: Apache-2.0
/// PX4's allocation: which motor commands a unit of its output makes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "firmware/firmware_parts.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::exports {

/// The order in which PX4 counts the rotors of a vehicle: those of a quadrotor in X from the front
/// right over the back left and the front left to the back right, others as the vehicle has them.
/// @return  indices into vehicle.rotors
[[nodiscard]] std::vector<std::size_t> px4_order(const Vehicle& vehicle);

/// Whether they are four, one in each quarter.
[[nodiscard]] bool px4_is_x(const Vehicle& vehicle);
/// Drag torque over thrust, of the squares of the speed, of which both mostly consist [m].
[[nodiscard]] double px4_torque_ratio(const Rotor& rotor);

/// (n × 3) commands per unit of roll, pitch and yaw output, rows in the vehicle's order: the
/// pseudo-inverse of the geometry in CA_ROTOR*, or of the vehicle's own where the values do not say
/// it, with its columns scaled as PX4 does.
/// @throws InvalidInput  for another number of rotors, or a geometry that cannot turn
[[nodiscard]] Eigen::MatrixXd px4_mix(const Vehicle& vehicle, const ParameterValues& value);

}  // namespace quadtune::exports
