// SPDX-License-Identifier: Apache-2.0
/// Linear models of a vehicle near a steady flight, in the states and inputs of a convention.
/// Derivation: docs/theory.md, "Trim and linearization".
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/design.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// Selects the states of a model.
struct StateSelection {
  /// Which states of a convention a model has.
  enum class Kind {
    full,  ///< all 12
    /// Without horizontal position and velocity: the states that can be estimated without GPS.
    no_position,
    list,  ///< the listed ones, in the order of the list
  };
  Kind kind = Kind::full;          ///< which states
  std::vector<std::string> names;  ///< state names of the convention; for Kind::list only
};

/// Parses "full", "no-position" or names separated by commas or blanks.
/// @throws InvalidInput  if the text contains no name.
[[nodiscard]] StateSelection state_selection(const std::string& text, const std::string& where);

/// Indices of the selected states in the 12 states of the convention.
/// @throws InvalidInput  for an unknown name (with the nearest), a repeated name, or an empty list.
[[nodiscard]] std::vector<Eigen::Index> selected_states(const Convention& convention,
                                                        const StateSelection& selection,
                                                        const std::string& where);

/// The states and inputs of a linear model.
struct LinearizeOptions {
  std::string convention = "ned";             ///< name of a registered convention
  InputKind inputs = InputKind::rotor_speed;  ///< quantities that are the inputs of the model
  StateSelection states;                      ///< states of the model; by default all
};

/// The options for the LQR problem of a design.
[[nodiscard]] LinearizeOptions linearize_options(const LqrDesign& design);

/// ẋ ≈ A (x - x0(t)) + B (u - u0) + x0'(t) near a steady flight x0(t), u0.
///
/// The flight may move: in a line x0' is the ground velocity; in a circle or a spin the yaw
/// rotates. A and B are constant in all cases. If the yaw rotates, the position deviation is
/// expressed in axes that coincide with the world's at the linearized instant and then rotate with
/// the heading.
struct Linearization {
  TrimResult trim;      ///< in ned_convention() and rotor speeds
  ContinuousLti plant;  ///< A (nx × nx), B (nx × nu) with names and units; all NaN unless solved
  Eigen::VectorXd x0;   ///< (nx) trim of the selected states at the linearized instant
  Eigen::VectorXd x0_rate;                        ///< (nx) their time derivative in the trim
  Eigen::VectorXd u0;                             ///< (nu) trim of the inputs
  std::string convention;                         ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;  ///< the quantities u
  /// Remarks for the reader, e.g. on dependence on states that were left out.
  std::vector<std::string> notes;

  /// Whether there is a trim, and therefore a model.
  [[nodiscard]] bool solved() const { return trim.solved(); }
};

/// Linearizes the equations of motion at a trim; the Jacobians are exact up to rounding.
///
/// Inputs: rotor-speed (rad/s), rotor-thrust (N), wrench (N, N m; the rotors' angular momentum is
/// constant), command (the motor's unit, without the direction sign).
///
/// @param vehicle  of which `trimmed` is a trim
/// @param trimmed  a trim of this vehicle; if it is not solved, the result is NaN with
///                 trim.culprit.
/// @param options  states, inputs and convention of the model
/// @throws InvalidInput  if the convention is unknown, the state selection is invalid, or A or B is
///                       not finite.
[[nodiscard]] Linearization linearize(const Vehicle& vehicle, const TrimResult& trimmed,
                                      const LinearizeOptions& options = {});

/// Linearizes many trims of one vehicle whose parameters may change, but not the number of its
/// rotors or the unit of its motors. Names and conventions are resolved once. The notes are empty.
class Linearizer {
 public:
  /// @throws InvalidInput  as linearize().
  Linearizer(const Vehicle& vehicle, const LinearizeOptions& options);

  /// A result with names whose numbers are all NaN.
  [[nodiscard]] const Linearization& unsolved() const { return unsolved_; }

  /// @return  valid until the next call.  @throws InvalidInput  if A or B is not finite.
  const Linearization& at(const Vehicle& vehicle, const TrimResult& trimmed);

 private:
  Linearization unsolved_;
  Linearization result_;
  std::vector<Eigen::Index> kept_;
  Eigen::MatrixXd M_;  // x = M x_ned, selected states only
  Eigen::MatrixXd N_;  // u = N u_ned
};

/// Computes the trim and linearizes at it.
/// @throws InvalidInput  also as trim().
[[nodiscard]] Linearization linearize(const Vehicle& vehicle, const FlightCondition& condition,
                                      const LinearizeOptions& options = {},
                                      const TrimOptions& trim_options = {});

}  // namespace quadtune
