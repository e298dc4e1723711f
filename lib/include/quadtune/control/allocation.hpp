// SPDX-License-Identifier: Apache-2.0
/// Converts the wrench of a law to rotor speeds as flight code does it: with one matrix and one
/// square root per rotor.
#pragma once

#include <Eigen/Core>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Thrusts that produce a wrench: t = t0 + P (wrench - wrench0), of least norm if there are more
/// than four rotors.
///
/// Thrust and the torques about body x and y are exact. The drag torque is linearized in the thrust
/// at hover, which is exact if it is proportional to thrust.
template <class T>
struct Allocation {
  int rotors = 0;  ///< number of rotors, 1 to kMaxRotors
  Eigen::Matrix<T, kMaxRotors, 4> P = Eigen::Matrix<T, kMaxRotors, 4>::Zero();  ///< [1, 1/m …]
  /// From changes of the thrusts to those of the wrench; M P is the identity.
  Eigen::Matrix<T, 4, kMaxRotors> M = Eigen::Matrix<T, 4, kMaxRotors>::Zero();
  Eigen::Matrix<T, 4, 1> wrench0 = Eigen::Matrix<T, 4, 1>::Zero();  ///< at hover
  RotorSpeeds<T> thrust0;                                           ///< at hover [N]
  std::array<T, kMaxRotors> a2{};  ///< T = a2 w² + a1 w [N s²/rad²]
  std::array<T, kMaxRotors> a1{};  ///< likewise [N s/rad]
};

/// The allocation of a vehicle, with the hover thrusts of least norm.
/// @throws InvalidInput  if there are more than kMaxRotors rotors, if they cannot produce every
///                       wrench, or if hover requires a negative thrust
[[nodiscard]] Allocation<double> allocation(const Vehicle& vehicle);

/// Speed [rad/s] at which a rotor with a2 > 0 produces `thrust` [N]; negative thrusts count as 0.
template <class T>
[[nodiscard]] T speed_for_thrust(const T& thrust, const T& a2, const T& a1) {
  using std::sqrt;
  const T t = max_of(thrust, T(0));
  // The larger root of a2 w² + a1 w = T.
  return max_of((sqrt(a1 * a1 + T(4) * a2 * t) - a1) / (T(2) * a2), T(0));
}

/// Speeds for a wrench [T τx τy τz]; the motors' limits are not applied. [rad/s]
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
