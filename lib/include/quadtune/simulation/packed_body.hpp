// SPDX-License-Identifier: Apache-2.0
/// Combines the parameters of several vehicles into one body for the equations of motion, one
/// vehicle per lane.
#pragma once

#include <array>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/simulation/pack.hpp"

namespace quadtune {

/// @param bodies  one per lane, all with the same number of rotors. Drag and products of inertia
///                are computed for all lanes if any of the bodies has them.
template <int N>
[[nodiscard]] BasicRigidBody<Pack<N>> packed_body(const std::array<RigidBody, N>& bodies) {
  using P = Pack<N>;
  BasicRigidBody<P> body;
  body.rotor_count = bodies[0].rotor_count;
  body.has_drag = false;
  body.principal_axes = true;
  for (const RigidBody& b : bodies) {
    body.has_drag = body.has_drag || b.has_drag;
    body.principal_axes = body.principal_axes && b.principal_axes;
    body.has_airflow = body.has_airflow || b.has_airflow;
    body.has_ground_effect = body.has_ground_effect || b.has_ground_effect;
  }
  const auto gather = [&](P& target, auto&& number) {
    for (int l = 0; l < N; ++l) set_lane(target, l, number(bodies[static_cast<std::size_t>(l)]));
  };
  gather(body.mass, [](const RigidBody& b) { return b.mass; });
  gather(body.inverse_mass, [](const RigidBody& b) { return b.inverse_mass; });
  gather(body.gravity, [](const RigidBody& b) { return b.gravity; });
  gather(body.air_density, [](const RigidBody& b) { return b.air_density; });
  gather(body.density_ratio, [](const RigidBody& b) { return b.density_ratio; });
  for (int i = 0; i < 3; ++i) {
    gather(body.cda(i), [&](const RigidBody& b) { return b.cda(i); });
    gather(body.linear_drag(i), [&](const RigidBody& b) { return b.linear_drag(i); });
    for (int j = 0; j < 3; ++j) {
      gather(body.J(i, j), [&](const RigidBody& b) { return b.J(i, j); });
      gather(body.J_inv(i, j), [&](const RigidBody& b) { return b.J_inv(i, j); });
    }
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(body.rotor_count); ++i) {
    BasicRotor<P>& rotor = body.rotors[i];
    for (int k = 0; k < 3; ++k)
      gather(rotor.position(k), [&](const RigidBody& b) { return b.rotors[i].position(k); });
    gather(rotor.spin, [&](const RigidBody& b) { return b.rotors[i].spin; });
    gather(rotor.thrust_a2, [&](const RigidBody& b) { return b.rotors[i].thrust_a2; });
    gather(rotor.thrust_a1, [&](const RigidBody& b) { return b.rotors[i].thrust_a1; });
    gather(rotor.torque_d2, [&](const RigidBody& b) { return b.rotors[i].torque_d2; });
    gather(rotor.torque_d1, [&](const RigidBody& b) { return b.rotors[i].torque_d1; });
    gather(rotor.inertia, [&](const RigidBody& b) { return b.rotors[i].inertia; });
    gather(rotor.lag, [&](const RigidBody& b) { return b.rotors[i].lag; });
    gather(rotor.lag_down, [&](const RigidBody& b) { return b.rotors[i].lag_down; });
    gather(rotor.drag, [&](const RigidBody& b) { return b.rotors[i].drag; });
    gather(rotor.inflow, [&](const RigidBody& b) { return b.rotors[i].inflow; });
    gather(rotor.flapping, [&](const RigidBody& b) { return b.rotors[i].flapping; });
    gather(rotor.ground_radius, [&](const RigidBody& b) { return b.rotors[i].ground_radius; });
  }
  return body;
}

}  // namespace quadtune
