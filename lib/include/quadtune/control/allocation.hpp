// SPDX-License-Identifier: Apache-2.0
/// From the wrench that a law asks for to the speeds of the rotors, as flight programs do it: one
/// matrix and one square root a rotor.
#pragma once

#include <Eigen/Core>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Thrusts that give a wrench: t = t0 + P (wrench - wrench0), least in norm where rotors are more
/// than four.
///
/// Thrust and torques about the axes of the rotors are met exactly. The drag torque follows the
/// thrust with the slope that it has at hover: exact where it is proportional to thrust.
template <class T>
struct Allocation {
  int rotors = 0;
  Eigen::Matrix<T, kMaxRotors, 4> P = Eigen::Matrix<T, kMaxRotors, 4>::Zero();  ///< [1, 1/m …]
  Eigen::Matrix<T, 4, kMaxRotors> M = Eigen::Matrix<T, 4, kMaxRotors>::Zero();  ///< M P = 1
  Eigen::Matrix<T, 4, 1> wrench0 = Eigen::Matrix<T, 4, 1>::Zero();              ///< at hover
  RotorSpeeds<T> thrust0;                                                       ///< at hover [N]
  std::array<T, kMaxRotors> a2{};                                               ///< thrust curves
  std::array<T, kMaxRotors> a1{};
};

/// The allocation of a vehicle whose rotors share the weight by least norm.
/// @throws InvalidInput  if the rotors cannot make every wrench, or cannot hover.
[[nodiscard]] Allocation<double> allocation(const Vehicle& vehicle);

/// Speed at which a rotor gives `thrust`; a thrust below 0 counts as 0. [rad/s]
template <class T>
[[nodiscard]] T speed_for_thrust(const T& thrust, const T& a2, const T& a1) {
  using std::sqrt;
  const T t = greater(thrust, T(0));
  // The larger root of a2 w² + a1 w = T.
  return greater((sqrt(a1 * a1 + T(4) * a2 * t) - a1) / (T(2) * a2), T(0));
}

/// Speeds for a wrench [T τx τy τz]; the motors' limits are not looked at. [rad/s]
template <class T>
[[nodiscard]] RotorSpeeds<T> speeds_of_wrench(const Allocation<T>& allocation,
                                              const Eigen::Matrix<T, 4, 1>& wrench) {
  RotorSpeeds<T> speeds(allocation.rotors);
  const Eigen::Matrix<T, 4, 1> change = wrench - allocation.wrench0;
  for (int i = 0; i < allocation.rotors; ++i) {
    T thrust = allocation.thrust0(i);
    for (int j = 0; j < 4; ++j) thrust += allocation.P(i, j) * change(j);
    const auto k = static_cast<std::size_t>(i);
    speeds(i) = speed_for_thrust(thrust, allocation.a2[k], allocation.a1[k]);
  }
  return speeds;
}

}  // namespace quadtune
