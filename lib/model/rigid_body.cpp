// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/rigid_body.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include "quadtune/errors.hpp"

namespace quadtune {

template <>
RigidBody RigidBody::of_vehicle(const Vehicle& vehicle, double ratio) {
  const std::string where = "vehicle '" + vehicle.name + "'";
  if (!(vehicle.mass > 0) || !std::isfinite(vehicle.mass))
    throw InvalidInput(where,
                       fmt::format("mass is {} kg, expected a positive number", vehicle.mass));
  if (!std::isfinite(vehicle.gravity))
    throw InvalidInput(where, "gravity is not finite, expected a number of m/s²");
  if (vehicle.rotors.empty() || vehicle.rotors.size() > static_cast<std::size_t>(kMaxRotors))
    throw InvalidInput(
        where, fmt::format("{} rotors, expected 1 to {}", vehicle.rotors.size(), kMaxRotors));
  if (!(ratio >= 0) || !std::isfinite(vehicle.air_density * ratio))
    throw InvalidInput(where, fmt::format("density ratio is {}, expected a number that is not "
                                          "negative",
                                          ratio));
  const Eigen::Matrix3d& J = vehicle.inertia;
  const Eigen::LLT<Eigen::Matrix3d> llt(J);
  if (!J.allFinite() || !J.isApprox(J.transpose(), 1e-10) || llt.info() != Eigen::Success)
    throw InvalidInput(where,
                       "inertia is not symmetric and positive definite, which is required because "
                       "the rates are computed with its inverse");
  RigidBody body;
  body.mass = vehicle.mass;
  body.inverse_mass = 1 / vehicle.mass;
  body.gravity = vehicle.gravity;
  body.J = J;
  body.J_inv = llt.solve(Eigen::Matrix3d::Identity());
  body.cda = vehicle.drag.cda;
  body.linear_drag = vehicle.drag.linear;
  body.has_drag = !body.cda.isZero(0) || !body.linear_drag.isZero(0);
  body.principal_axes = J.isDiagonal(0);
  body.air_density = vehicle.air_density * ratio;
  body.density_ratio = ratio;
  for (const Rotor& rotor : vehicle.rotors)
    body.rotors[static_cast<std::size_t>(body.rotor_count++)] = {
        rotor.position,
        spin_sign(rotor.spin),
        rotor.thrust_a2,
        rotor.thrust_a1,
        rotor.torque_d2,
        rotor.torque_d1,
        rotor.inertia,
        rotor.lag,
        lag_down(rotor),
        rotor.drag,
        rotor.inflow,
        rotor.flapping,
        rotor.ground_effect && rotor.radius > 0 ? rotor.radius : 0};
  for (const Rotor& rotor : vehicle.rotors) {
    body.has_airflow =
        body.has_airflow || rotor.drag != 0 || rotor.inflow != 0 || rotor.flapping != 0;
    body.has_ground_effect = body.has_ground_effect || (rotor.ground_effect && rotor.radius > 0);
  }
  return body;
}

}  // namespace quadtune
