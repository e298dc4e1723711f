// SPDX-License-Identifier: Apache-2.0
/// Maps rotor speeds to the wrench and back, for any layout. All signs follow from the positions
/// and spins of the rotors.
///
/// The wrench is [T τx τy τz]: total thrust T ≥ 0 [N] along body -z, torques [N m] about the centre
/// of mass in body axes forward-right-down.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// The wrench of rotors turning at w [rad/s], with the vehicle's exact thrust and torque curves.
///
/// @param vehicle        source of rotors and curves
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

/// By how much each component of the wrench alone (thrust, roll, pitch, yaw) can change in either
/// direction from its value at speeds w [rad/s] until a rotor reaches a limit of its command, to
/// first order [N, N m]. 0 if no rotor affects the component. With more than four rotors the speed
/// change of least norm is used.
/// @throws InvalidInput  unless w has one entry per rotor.
[[nodiscard]] Eigen::Vector4d wrench_authority(const Vehicle& vehicle, const Eigen::VectorXd& w);

/// ∂wrench/∂w at speeds w [rad/s], (4 × n).
/// @throws InvalidInput  unless w has one entry per rotor.
[[nodiscard]] Eigen::MatrixXd wrench_jacobian(const Vehicle& vehicle, const Eigen::VectorXd& w,
                                              double density_ratio = 1);

/// Wrench per squared speed, (4 × n) [N s²/rad², N m s²/rad²]: wrench = M w².
/// @throws InvalidInput  if a thrust or torque curve has a linear term, since no such matrix exists
///                       then.
[[nodiscard]] Eigen::MatrixXd mixer_matrix(const Vehicle& vehicle);

/// Wrench per rotor thrust, (4 × n) [1, m, m, m]: wrench = M T.
/// @throws InvalidInput  if a rotor's drag torque is not proportional to its thrust.
[[nodiscard]] Eigen::MatrixXd allocation_matrix(const Vehicle& vehicle);

/// The outcome of a computation of rotor speeds.
enum class MixStatus {
  solved,  ///< the wrench is produced within the limits
  /// Motors saturate: the speeds produce the nearest wrench that was found.
  saturated,
  infeasible,  ///< the layout cannot produce this wrench at any speed
};

/// "solved", "saturated" or "infeasible".
[[nodiscard]] std::string to_string(MixStatus status);

/// Rotor speeds and the wrench that they produce.
struct MixResult {
  MixStatus status = MixStatus::infeasible;  ///< whether the rotors produce the wrench
  Eigen::VectorXd w;                         ///< (n) [rad/s], always within the motors' limits
  Eigen::Vector4d wrench;                    ///< wrench at speeds w [N, N m]
  Eigen::Vector4d missing;                   ///< requested minus produced wrench [N, N m]
  /// Norm of `missing`, each entry divided by what all rotors produce at full speed.
  double residual = 0;
  int iterations = 0;  ///< Newton steps
  /// The saturated rotors, their limits and the missing wrench; empty if solved.
  std::string culprit;

  /// Whether the rotors produce the wrench.
  [[nodiscard]] bool solved() const { return status == MixStatus::solved; }
};

/// Computes rotor speeds that produce a wrench, by Newton's method on the exact curves. With more
/// than four rotors each step is the speed change of least norm; rotors that reach a limit stay
/// there, and the others share the rest.
///
/// @param vehicle        at least one rotor
/// @param wrench         requested [T τx τy τz] [N, N m].
/// @param density_ratio  Density of the air over vehicle.air_density, > 0.
/// @throws InvalidInput  if an entry is not finite or the density ratio is not positive.
[[nodiscard]] MixResult speeds_for_wrench(const Vehicle& vehicle, const Eigen::Vector4d& wrench,
                                          double density_ratio = 1);

/// Minimum rotor speed [rad/s], from the motors' command limits.
[[nodiscard]] double min_speed(const Vehicle& vehicle);

/// Maximum rotor speed [rad/s], from the motors' command limits.
[[nodiscard]] double max_speed(const Vehicle& vehicle);

/// Sum of all thrusts at the maximum speed [N].
[[nodiscard]] double max_thrust(const Vehicle& vehicle, double density_ratio = 1);

/// The maximum thrust divided by the weight [1].
[[nodiscard]] double thrust_to_weight(const Vehicle& vehicle);

/// Maximum thrust that the altitude loop may command [N]: altitude_thrust_fraction of
/// max_thrust().
[[nodiscard]] double altitude_thrust_limit(const Vehicle& vehicle);

/// Motor command per newton of one rotor's thrust, for a squared-speed command [count/N].
/// @throws InvalidInput  unless all rotors are identical, T = a2 w², and the command is a squared
///                       speed.
[[nodiscard]] double command_per_thrust(const Vehicle& vehicle);

/// The Mambo project's mixer: thrusts t counted along body +z (so t < 0 lifts), rows
/// [force along z, yaw, pitch, roll].
struct ThrustMixer {
  Eigen::Matrix4d Ts2Q;  ///< [F_z τz τy τx] = Ts2Q t [1, m, m, m]
  Eigen::Matrix4d Q2Ts;  ///< its inverse [1, 1/m, 1/m, 1/m]
};

/// @throws InvalidInput  unless the vehicle has four rotors, their drag torques are proportional to
///                       their thrusts, and they can produce every wrench.
[[nodiscard]] ThrustMixer thrust_mixer(const Vehicle& vehicle);

}  // namespace quadtune
