// SPDX-License-Identifier: Apache-2.0
/// A state-feedback gain with everything that is needed to apply it rightly.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// Longest lag of an actuator [s], and most past commands that a law feeds back.
inline constexpr double kMostActuatorLag = 1;
inline constexpr int kMostPastCommands = 40;

/// The part of a law that feeds back its own past commands, for actuators that follow them late.
///
/// The law computes the state m of the actuators from the commands u that the motors could carry
/// out: m[k+1] = m[k] + (1 - e^(-dt/lag)) (u[k - past] - m[k]) for each input. It adds
/// -K_lag (m[k] - u0) - K_past [u[k-1] - u0; u[k-2] - u0; …] to its command.
struct CommandMemory {
  Eigen::VectorXd lag;     ///< (nu) time constants [s], > 0
  Eigen::MatrixXd K_lag;   ///< (nu × nu)
  int past = 0;            ///< control periods from a command to its actuator, ≥ 0
  Eigen::MatrixXd K_past;  ///< (nu × past nu), the newest command first
};

/// Bounds that keep a state feedback near the flight that its gains were made for.
struct FeedbackLimits {
  /// The law sees an error of the horizontal position of at most this length [m], > 0.
  double position_error = std::numeric_limits<double>::infinity();
  /// Whether an integral stops growing in a direction in which the motors produce no more.
  bool conditional_integration = false;

  friend bool operator==(const FeedbackLimits&, const FeedbackLimits&) = default;
};

/// Axes in which a law sees the error of the horizontal position.
enum class PositionAxes {
  world,    ///< north and east: right at the heading of the trim
  heading,  ///< the error in px and py, and its integral, turned from the trim's heading to the
            ///< vehicle's, so that the law is the same whatever the heading
};
/// "world", "heading", and back.
[[nodiscard]] std::string to_string(PositionAxes axes);
[[nodiscard]] PositionAxes position_axes(const std::string& name, const std::string& where);

/// u = u0 + K (x_sp - x) + K_int ∫(x_sp - x) for SignLaw::set_point_minus_state.
///
/// The integral is over the listed states only, in seconds times the state's unit, advanced once a
/// sample by the error times dt.
struct Gains {
  Eigen::MatrixXd K;              ///< (nu × nx) [input unit / state unit]
  Eigen::MatrixXd K_int;          ///< (nu × ni) [input unit / (state unit · s)]; ni may be 0
  std::vector<Signal> states;     ///< nx
  std::vector<Signal> inputs;     ///< nu
  std::vector<Signal> integrals;  ///< ni; names of integrated states, their units times s
  Eigen::VectorXd x0;             ///< (nx) trim state, the set point that the gain was made for
  Eigen::VectorXd u0;             ///< (nu) trim input
  std::string vehicle;            ///< name of the vehicle
  std::string convention;         ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;
  SignLaw sign_law = SignLaw::set_point_minus_state;
  double dt = 0;                             ///< sample period of the law [s]; 0 means continuous
  std::optional<CommandMemory> memory = {};  ///< only with dt > 0
  PositionAxes axes = PositionAxes::world;
  FeedbackLimits limits = {};
};

/// Checks shapes and finiteness.
/// @throws InvalidInput  naming the matrix, its shape and what was expected.
void validate(const Gains& gains, const std::string& where);

/// The listed states as Gains::integrals: their names, their units times s. Names of no state are
/// passed over.
[[nodiscard]] std::vector<Signal> integral_signals(const std::vector<Signal>& states,
                                                   const std::vector<std::string>& integrated);

/// The loop of the gains, integrals included, cut at the plant's inputs: L with L under negative
/// feedback the loop as it flies.
///
/// @param plant  sampled, with the gains' states in any order, and the gains' inputs
/// @return       nx + ni states, those of the gains and their integrals, then those of the memory
/// if
///               the gains have one; nu inputs and outputs
/// @throws InvalidInput  for a plant of other states or inputs
[[nodiscard]] DiscreteLti open_loop(const DiscreteLti& plant, const Gains& gains);

}  // namespace quadtune
