// SPDX-License-Identifier: Apache-2.0
/// What a flight program calls its states and inputs, in which order, along which axes and with
/// which sign law. Inside quadtune everything is `ned`; a convention is applied once, at the
/// boundary.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"

namespace quadtune {

/// What the control law commands.
enum class InputKind {
  rotor_speed,   ///< one speed per rotor [rad/s]
  rotor_thrust,  ///< one thrust per rotor [N]
  wrench,        ///< total thrust and three torques [N, N m]
  command,       ///< one motor command per rotor, in the vehicle's own unit
};

/// How the flight program applies the gain.
enum class SignLaw {
  set_point_minus_state,  ///< u = u0 + K (x_sp - x): K is the plain LQR gain of u = -K x
  state_minus_set_point,  ///< u = u0 + K (x - x_sp): K is the negated LQR gain
};

/// A flight program's state vector and input axes as a signed permutation of quadtune's own.
/// Both the Euler sequence (yaw, pitch, roll) and the body origin are shared, so the map is exact
/// for the nonlinear state as well, not only near hover.
struct Convention {
  std::string name;                        ///< "ned", "uquad" or "mambo"
  std::string description;                 ///< axes in words, for manifests and reports
  std::vector<Signal> states;              ///< 12, in the flight program's order
  Eigen::Matrix<double, 12, 12> from_ned;  ///< x = from_ned · x_ned, entries 0, ±1, orthogonal
  std::vector<Signal> wrench;              ///< 4 names of [thrust, torques]
  Eigen::Matrix4d wrench_from_ned;         ///< signed permutation of [T, τx, τy, τz]
  SignLaw sign_law = SignLaw::set_point_minus_state;
};

/// quadtune's own state: px py pz (world north-east-down [m]), roll pitch yaw [rad],
/// u v w (body forward-right-down [m/s]), p q r (body rates [rad/s]); wrench [T τx τy τz] with
/// thrust T ≥ 0 along body -z.
[[nodiscard]] const Convention& ned_convention();

/// The built-in conventions in the order of the documentation: ned, uquad, mambo.
[[nodiscard]] const std::vector<Convention>& conventions();

/// @throws InvalidInput  naming the word, the conventions that exist, and the nearest.
[[nodiscard]] const Convention& convention(const std::string& name, const std::string& where);

/// Names and units of the inputs of `kind` for a vehicle of `rotors` rotors, e.g. w1 w2 w3 w4.
/// @param command_unit  unit of the motor command, used by InputKind::command.
[[nodiscard]] std::vector<Signal> input_signals(const Convention& convention, InputKind kind,
                                                int rotors, const std::string& command_unit);

/// u = M · u_ned for inputs of `kind`: identity but for the wrench.
[[nodiscard]] Eigen::MatrixXd input_from_ned(const Convention& convention, InputKind kind,
                                             int rotors);

/// "rotor-speed", "rotor-thrust", "wrench" or "command", and back.
[[nodiscard]] std::string to_string(InputKind kind);
[[nodiscard]] InputKind input_kind(const std::string& name, const std::string& where);

/// "set-point-minus-state" or "state-minus-set-point", and back.
[[nodiscard]] std::string to_string(SignLaw law);
[[nodiscard]] SignLaw sign_law(const std::string& name, const std::string& where);

}  // namespace quadtune
