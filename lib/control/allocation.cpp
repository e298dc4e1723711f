// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/allocation.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {

Allocation<double> allocation(const Vehicle& vehicle) {
  const auto n = static_cast<Eigen::Index>(vehicle.rotors.size());
  if (n < 1 || n > kMaxRotors)
    throw InvalidInput("vehicle '" + vehicle.name + "'",
                       fmt::format("{} rotors, expected 1 to {}", n, kMaxRotors));
  Allocation<double> result;
  result.rotors = static_cast<int>(n);
  // Two passes: the second uses the drag torque's slope at the hover thrusts of the first.
  result.thrust0 =
      RotorSpeeds<double>::Constant(n, vehicle.mass * vehicle.gravity / static_cast<double>(n));
  for (int pass = 0; pass < 2; ++pass) {
    Eigen::MatrixXd M(4, n);
    Eigen::Vector4d wrench = Eigen::Vector4d::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
      const double thrust = result.thrust0(i);
      const double w = rotor_speed_for_thrust(rotor, std::max(thrust, 0.0));
      const double s = spin_sign(rotor.spin);
      const double torque_per_thrust =
          (2 * rotor.torque_d2 * w + rotor.torque_d1) / (2 * rotor.thrust_a2 * w + rotor.thrust_a1);
      M.col(i) << 1, -rotor.position.y(), rotor.position.x(), -s * torque_per_thrust;
      wrench += Eigen::Vector4d(thrust, -rotor.position.y() * thrust, rotor.position.x() * thrust,
                                -s * rotor_torque(rotor, w));
      result.a2[static_cast<std::size_t>(i)] = rotor.thrust_a2;
      result.a1[static_cast<std::size_t>(i)] = rotor.thrust_a1;
    }
    // Rows in units of force, so that the rank does not depend on the unit of length.
    Eigen::Vector4d scale;
    for (int row = 0; row < 4; ++row) scale(row) = 1 / std::max(M.row(row).norm(), 1e-300);
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(scale.asDiagonal() * M);
    if (inverse.rank() < 4)
      throw InvalidInput(
          "vehicle '" + vehicle.name + "'",
          "the rotors cannot produce every wrench, expected a layout that can because "
          "the law commands thrust and three torques");
    const Eigen::MatrixXd P = inverse.pseudoInverse() * scale.asDiagonal();
    const Eigen::Vector4d hover(vehicle.mass * vehicle.gravity, 0, 0, 0);
    result.P.topRows(n) = P;
    result.M.leftCols(n) = M;
    result.thrust0 += P * (hover - wrench);
    if (pass == 1) result.wrench0 = hover;
    if ((result.thrust0.array() < 0).any())
      throw InvalidInput(
          "vehicle '" + vehicle.name + "'",
          "hover requires negative thrust from a rotor, expected thrusts of 0 or more");
  }
  return result;
}

}  // namespace quadtune
