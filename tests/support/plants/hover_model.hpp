// SPDX-License-Identifier: Apache-2.0
/// The uquad's hover model derived by hand, independent of lib/model and linearize.
#pragma once

#include <cmath>

#include "quadtune/lti.hpp"

namespace quadtune::testing {

/// 12 states in the uquad convention, 4 rotor speeds; 1.741 kg, public project values
/// (docs/bibliography.md).
inline ContinuousLti uquad_hover() {
  constexpr double m = 1.741, L = 0.29, Ixx = 2.32e-2, Izz = 4.37e-2, g = 9.81;
  constexpr double a2 = 4.60160135072435e-5, a1 = -0.00103822726273726;
  constexpr double d2 = 3.4734e-6, d1 = -1.3205e-4;
  // m g / 4 = a2 w² + a1 w
  const double w0 = (-a1 + std::sqrt(a1 * a1 + a2 * m * g)) / (2 * a2);
  const double dT = 2 * a2 * w0 + a1;
  const double dQ = 2 * d2 * w0 + d1;
  ContinuousLti plant;
  plant.A = Eigen::MatrixXd::Zero(12, 12);
  plant.A.block(0, 6, 3, 3).setIdentity();
  plant.A.block(3, 9, 3, 3).setIdentity();
  plant.A(6, 4) = g;   // nose down (positive phi) accelerates forward
  plant.A(7, 3) = -g;  // roll to the right (positive psi) accelerates to the right, that is -y
  plant.B = Eigen::MatrixXd::Zero(12, 4);
  plant.B.row(8).setConstant(dT / m);
  plant.B.row(9) << 0, L * dT / Ixx, 0, -L * dT / Ixx;
  plant.B.row(10) << -L * dT / Ixx, 0, L * dT / Ixx, 0;
  plant.B.row(11) << -dQ / Izz, dQ / Izz, -dQ / Izz, dQ / Izz;
  for (const char* name : {"x", "y", "z"}) plant.states.push_back({name, "m"});
  for (const char* name : {"psi", "phi", "theta"}) plant.states.push_back({name, "rad"});
  for (const char* name : {"vqx", "vqy", "vqz"}) plant.states.push_back({name, "m/s"});
  for (const char* name : {"wqx", "wqy", "wqz"}) plant.states.push_back({name, "rad/s"});
  for (const char* name : {"w1", "w2", "w3", "w4"}) plant.inputs.push_back({name, "rad/s"});
  return plant;
}

}  // namespace quadtune::testing
