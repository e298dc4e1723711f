// SPDX-License-Identifier: Apache-2.0
/// The names, order, axes and sign law that a flight code uses for its states and inputs. All of
/// quadtune computes in the convention `ned`; another convention is applied once, on input or
/// output.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"

namespace quadtune {

/// The quantity that the control law commands.
enum class InputKind {
  rotor_speed,   ///< one speed per rotor [rad/s]
  rotor_thrust,  ///< one thrust per rotor [N]
  wrench,        ///< total thrust and three torques [N, N m]
  command,       ///< one command per motor, in the vehicle's own unit
};

/// The sign with which the flight code applies the gain.
enum class SignLaw {
  set_point_minus_state,  ///< u = u0 + K (x_sp - x): K is the plain LQR gain of u = -K x
  state_minus_set_point,  ///< u = u0 + K (x - x_sp): K is the negated LQR gain
};

/// A flight code's state vector and input axes as a signed permutation of those of
/// ned_convention(). The Euler sequence (yaw, pitch, roll) and the origin of the body axes are the
/// same, so the map is exact for the nonlinear state, not only near hover.
struct Convention {
  std::string name;                        ///< e.g. "ned"; that of a convention file is its own
  std::string description;                 ///< axes in words, for manifests and reports
  std::vector<Signal> states;              ///< 12, in the flight code's order
  Eigen::Matrix<double, 12, 12> from_ned;  ///< x = from_ned · x_ned, entries 0, ±1, orthogonal
  std::vector<Signal> wrench;              ///< 4 names of [thrust, torques]
  Eigen::Matrix4d wrench_from_ned;         ///< signed permutation of [T, τx, τy, τz]
  SignLaw sign_law = SignLaw::set_point_minus_state;  ///< sign law of the program's gains
};

/// quadtune's own state: px py pz (world north-east-down [m]), roll pitch yaw [rad],
/// u v w (body forward-right-down [m/s]), p q r (body rates [rad/s]); wrench [T τx τy τz] with
/// thrust T ≥ 0 along body -z.
[[nodiscard]] const Convention& ned_convention();

/// The built-in conventions in the order of the documentation: ned, uquad, mambo.
[[nodiscard]] const std::vector<Convention>& conventions();

/// @throws InvalidInput  with the unknown name, the known conventions and the nearest of them.
[[nodiscard]] const Convention& convention(const std::string& name, const std::string& where);

/// Names and units of the inputs of `kind` for a vehicle of `rotors` rotors, e.g. w1 w2 w3 w4.
/// @param convention    source of the names of the wrench
/// @param kind          which inputs
/// @param rotors        number of rotors, ≥ 1
/// @param command_unit  unit of the motor command, used by InputKind::command.
[[nodiscard]] std::vector<Signal> input_signals(const Convention& convention, InputKind kind,
                                                int rotors, const std::string& command_unit);

/// The matrix M (nu × nu) in u = M · u_ned for inputs of `kind`: the identity except for the
/// wrench.
[[nodiscard]] Eigen::MatrixXd input_from_ned(const Convention& convention, InputKind kind,
                                             int rotors);

/// "rotor-speed", "rotor-thrust", "wrench" or "command".
[[nodiscard]] std::string to_string(InputKind kind);

/// The kind of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name and the known ones.
[[nodiscard]] InputKind input_kind(const std::string& name, const std::string& where);

/// "set-point-minus-state" or "state-minus-set-point".
[[nodiscard]] std::string to_string(SignLaw law);

/// The sign law of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name and the known ones.
[[nodiscard]] SignLaw sign_law(const std::string& name, const std::string& where);

}  // namespace quadtune
