// SPDX-License-Identifier: Apache-2.0
/// A state-feedback gain with all data that is needed to apply it correctly.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// Maximum lag of an actuator [s].
inline constexpr double kMaxActuatorLag = 1;
/// Maximum number of past commands that a law feeds back.
inline constexpr int kMaxPastCommands = 40;

/// Feedback of a law's own past commands, for actuators that follow the commands with a delay.
///
/// The law estimates the state m of the actuators from the commands u that the motors can carry
/// out: m[k+1] = m[k] + (1 - e^(-dt/lag)) (u[k - past] - m[k]) for each input. It adds
/// -K_lag (m[k] - u0) - K_past [u[k-1] - u0; u[k-2] - u0; …] to its command.
struct CommandMemory {
  Eigen::VectorXd lag;    ///< (nu) time constants [s], > 0, at most kMaxActuatorLag
  Eigen::MatrixXd K_lag;  ///< (nu × nu)
  /// Delay from a command to its actuator [control periods], 0 to kMaxPastCommands.
  int past = 0;
  Eigen::MatrixXd K_past;  ///< (nu × past · nu), newest command first
};

/// Limits that keep a state feedback near the flight condition that its gains were designed for.
struct FeedbackLimits {
  /// The horizontal position error that the law uses is limited to this length [m], > 0.
  double position_error = std::numeric_limits<double>::infinity();
  /// Whether an integral stops growing in a direction in which the motors are saturated.
  bool conditional_integration = false;

  friend bool operator==(const FeedbackLimits&, const FeedbackLimits&) = default;
};

/// The axes in which a law uses the horizontal position error.
enum class PositionAxes {
  world,  ///< north and east: correct only at the heading of the trim
  /// The errors of px and py and their integrals are rotated from the trim's heading to the
  /// vehicle's, so that the law does not depend on the heading.
  heading,
};
/// "world" or "heading".
[[nodiscard]] std::string to_string(PositionAxes axes);

/// The axes of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name and the two known ones.
[[nodiscard]] PositionAxes position_axes(const std::string& name, const std::string& where);

/// u = u0 + K (x_sp - x) + K_int ∫(x_sp - x) for SignLaw::set_point_minus_state.
///
/// Only the listed states are integrated. An integral, in the state's unit times seconds, is
/// advanced once per sample by the error times dt.
struct Gains {
  Eigen::MatrixXd K;              ///< (nu × nx) [input unit / state unit]
  Eigen::MatrixXd K_int;          ///< (nu × ni) [input unit / (state unit · s)]; ni may be 0
  std::vector<Signal> states;     ///< nx
  std::vector<Signal> inputs;     ///< nu
  std::vector<Signal> integrals;  ///< ni; names of the integrated states, their units times s
  Eigen::VectorXd x0;             ///< (nx) trim state, the set point that the gain was designed for
  Eigen::VectorXd u0;             ///< (nu) trim input
  std::string vehicle;            ///< name of the vehicle
  std::string convention;         ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;      ///< quantities that the law commands
  SignLaw sign_law = SignLaw::set_point_minus_state;  ///< sign law of K and K_int
  double dt = 0;                             ///< sample period of the law [s]; 0 means continuous
  std::optional<CommandMemory> memory = {};  ///< only with dt > 0
  PositionAxes axes = PositionAxes::world;   ///< axes of the horizontal position errors
  FeedbackLimits limits = {};                ///< of the position error and of the integrals
};

/// Validates shapes, that all entries are finite, that the sample period and the limits are in
/// range, and that gains with a memory have a sample period.
/// @throws InvalidInput  with the field, its value or shape, and what was expected
void validate(const Gains& gains, const std::string& where);

/// The signals of Gains::integrals for the listed states: their names, their units times s. Names
/// that are not states are ignored.
[[nodiscard]] std::vector<Signal> integral_signals(const std::vector<Signal>& states,
                                                   const std::vector<std::string>& integrated);

/// The loop transfer L of plant and gains, integrals included, cut at the plant's inputs: L under
/// negative feedback is the closed loop.
///
/// @param plant  sampled, with the states of the gains in any order, and the inputs of the gains in
///               their order; its outputs are not used
/// @param gains  with the sample period of the plant, or dt = 0; axes and limits are not used
/// @return       nx + ni states: the states of the gains, their integrals, then the states of the
///               memory if the gains have one; nu inputs and outputs
/// @throws InvalidInput  if the plant's states, inputs or period are not those of the gains
[[nodiscard]] DiscreteLti open_loop(const DiscreteLti& plant, const Gains& gains);

}  // namespace quadtune
