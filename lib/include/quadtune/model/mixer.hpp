// SPDX-License-Identifier: Apache-2.0
/// Wrench of the rotors and back, for any layout. Every sign follows from the rotors' positions and
/// spins; no layout has a name here.
///
/// The wrench is [T τx τy τz]: total thrust T ≥ 0 [N] along body -z, torques [N m] about the centre
/// of mass in body axes forward-right-down.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Wrench of rotors turning at w [rad/s], thrust and torque curves exactly as the vehicle has them.
///
/// @param w              (n) rotor speeds in the order of vehicle.rotors; doubles or jets.
/// @param density_ratio  Density of the air over vehicle.air_density.
/// @pre   w has vehicle.rotors.size() entries.
template <class Derived>
[[nodiscard]] Eigen::Matrix<typename Derived::Scalar, 4, 1> wrench_of_speeds(
    const Vehicle& vehicle, const Eigen::MatrixBase<Derived>& w, double density_ratio = 1) {
  using T = typename Derived::Scalar;
  Eigen::Matrix<T, 4, 1> wrench = Eigen::Matrix<T, 4, 1>::Zero();
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i) {
    const Rotor& rotor = vehicle.rotors[i];
    const T& wi = w.derived().coeff(static_cast<Eigen::Index>(i));
    const T thrust = rotor_thrust(rotor, wi, density_ratio);
    wrench(0) += thrust;
    wrench(1) -= rotor.position.y() * thrust;  // r × (0, 0, -T) = (-y T, x T, 0)
    wrench(2) += rotor.position.x() * thrust;
    wrench(3) -= spin_sign(rotor.spin) * rotor_torque(rotor, wi, density_ratio);  // reaction
  }
  return wrench;
}

/// How far each component of the wrench alone, thrust, roll, pitch, yaw, may move either way from
/// that at speeds w [rad/s] until a rotor meets a limit of its command, to first order [N, N m].
/// 0 where no rotor moves it. The least-norm change of speeds is taken where there are many.
/// @throws InvalidInput  if w has not one entry per rotor.
[[nodiscard]] Eigen::Vector4d wrench_authority(const Vehicle& vehicle, const Eigen::VectorXd& w);

/// ∂wrench/∂w at speeds w [rad/s], (4 × n).
/// @throws InvalidInput  if w has not one entry per rotor.
[[nodiscard]] Eigen::MatrixXd wrench_jacobian(const Vehicle& vehicle, const Eigen::VectorXd& w,
                                              double density_ratio = 1);

/// Wrench per squared speed, (4 × n) [N s²/rad², N m s²/rad²]: wrench = M w².
/// @throws InvalidInput  if a thrust or torque curve has a linear term, for then no such matrix is.
[[nodiscard]] Eigen::MatrixXd mixer_matrix(const Vehicle& vehicle);

/// Wrench per rotor thrust, (4 × n) [1, m, m, m]: wrench = M T.
/// @throws InvalidInput  if a rotor's drag torque is not proportional to its thrust.
[[nodiscard]] Eigen::MatrixXd allocation_matrix(const Vehicle& vehicle);

/// How the search for speeds ended.
enum class MixStatus {
  solved,      ///< the wrench is met within the limits
  saturated,   ///< a motor's limit stops it: the speeds give the nearest that was found
  infeasible,  ///< the layout cannot make this wrench at any speed
};

/// "solved", "saturated" or "infeasible".
[[nodiscard]] std::string to_string(MixStatus status);

/// Speeds and how well they do.
struct MixResult {
  MixStatus status = MixStatus::infeasible;
  Eigen::VectorXd w;        ///< (n) [rad/s], within the motor's limits whatever the status
  Eigen::Vector4d wrench;   ///< that w gives [N, N m]
  Eigen::Vector4d missing;  ///< asked minus given [N, N m]
  double residual = 0;      ///< |missing|, each entry over what all rotors give at their greatest
  int iterations = 0;
  std::string culprit;  ///< which rotor stands at which limit and what is missing; else empty

  [[nodiscard]] bool solved() const { return status == MixStatus::solved; }
};

/// Rotor speeds that give a wrench, by Newton steps on the exact curves. With more than four rotors
/// each step is the least change of speeds; rotors that meet a limit stay there and the others
/// share what is left.
///
/// @param wrench         [T τx τy τz] wanted [N, N m].
/// @param density_ratio  Density of the air over vehicle.air_density, > 0.
/// @throws InvalidInput  for entries that are not finite or a density ratio that is not positive.
[[nodiscard]] MixResult speeds_for_wrench(const Vehicle& vehicle, const Eigen::Vector4d& wrench,
                                          double density_ratio = 1);

/// Lowest and greatest speed of the rotors [rad/s], from the motor's command limits.
[[nodiscard]] double least_speed(const Vehicle& vehicle);
[[nodiscard]] double greatest_speed(const Vehicle& vehicle);

/// Sum of all thrusts at the greatest speed [N].
[[nodiscard]] double greatest_thrust(const Vehicle& vehicle, double density_ratio = 1);

/// The same over the weight [1].
[[nodiscard]] double thrust_to_weight(const Vehicle& vehicle);

/// Greatest total thrust that the altitude loop may ask for [N]: altitude_thrust_fraction of it.
[[nodiscard]] double altitude_thrust_limit(const Vehicle& vehicle);

/// Motor command per newton of one rotor's thrust, for a squared-speed command [count/N].
/// @throws InvalidInput  unless all rotors are alike, T = a2 w², and the command is squared speed.
[[nodiscard]] double command_per_thrust(const Vehicle& vehicle);

/// The Mambo project's mixer: thrusts t counted along body +z (so t < 0 lifts), rows
/// [force along z, yaw, pitch, roll].
struct ThrustMixer {
  Eigen::Matrix4d Ts2Q;  ///< [F_z τz τy τx] = Ts2Q t [1, m, m, m]
  Eigen::Matrix4d Q2Ts;  ///< its inverse [1, 1/m, 1/m, 1/m]
};

/// @throws InvalidInput  unless the vehicle has four rotors whose drag torque is proportional to
///                       their thrust and which can make every wrench.
[[nodiscard]] ThrustMixer thrust_mixer(const Vehicle& vehicle);

}  // namespace quadtune
