// SPDX-License-Identifier: Apache-2.0
/// Linear models of a vehicle near a steady flight, in a flight program's own states and inputs.
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

/// Which of the 12 states a model keeps.
struct StateSelection {
  enum class Kind {
    full,         ///< all 12
    no_position,  ///< without horizontal position and horizontal velocity: what is left without GPS
    list,         ///< the named ones, in the order of the list
  };
  Kind kind = Kind::full;
  std::vector<std::string> names;  ///< of the convention; for Kind::list only
};

/// Reads "full", "no-position" or names separated by commas or blanks.
/// @throws InvalidInput  if the text names nothing.
[[nodiscard]] StateSelection state_selection(const std::string& text, const std::string& where);

/// Where the selected states stand in the convention's 12.
/// @throws InvalidInput  for an unknown name (with the nearest), a name given twice, an empty list.
[[nodiscard]] std::vector<Eigen::Index> selected_states(const Convention& convention,
                                                        const StateSelection& selection,
                                                        const std::string& where);

/// In whose terms the model is written.
struct LinearizeOptions {
  std::string convention = "ned";  ///< name of a built-in convention
  InputKind inputs = InputKind::rotor_speed;
  StateSelection states;
};

/// Those of a design's LQR problem.
[[nodiscard]] LinearizeOptions linearize_options(const LqrDesign& design);

/// ẋ ≈ A (x - x0(t)) + B (u - u0) + x0'(t) near a steady flight x0(t), u0.
///
/// The flight may move: in a line x0' is the velocity over the ground, in a circle or a spin the
/// yaw goes round. A and B are constant all the same. With a yaw that goes round the deviation of
/// the position is measured along axes that are the world's at the linearized instant and then turn
/// with the heading.
struct Linearization {
  TrimResult trim;      ///< in ned_convention() and rotor speeds
  ContinuousLti plant;  ///< A (nx × nx), B (nx × nu) with names and units; all NaN unless solved
  Eigen::VectorXd x0;   ///< (nx) trim of the selected states at the linearized instant
  Eigen::VectorXd x0_rate;  ///< (nx) their time derivative in the trim
  Eigen::VectorXd u0;       ///< (nu) trim of the inputs
  std::string convention;   ///< name
  InputKind input_kind = InputKind::rotor_speed;
  std::vector<std::string> notes;  ///< what a reader must know, e.g. of states that were left out

  [[nodiscard]] bool solved() const { return trim.solved(); }
};

/// Jacobians of the equations of motion at a trim, exact to rounding.
///
/// Inputs: rotor-speed (rad/s), rotor-thrust (N), wrench (N, N m; the rotors' angular momentum is
/// held at the trim's), command (the motor's unit, without the direction sign).
///
/// @param trimmed  of this vehicle; where it is not solved the result holds NaN and trim.culprit.
/// @throws InvalidInput  for an unknown convention, a bad selection of states, A or B not finite.
[[nodiscard]] Linearization linearize(const Vehicle& vehicle, const TrimResult& trimmed,
                                      const LinearizeOptions& options = {});

/// The same for many trims of one vehicle, whose numbers may change, but not its rotors' number nor
/// its motors' unit: names and conventions are looked up once. The notes stay empty.
class Linearizer {
 public:
  /// @throws InvalidInput  as linearize().
  Linearizer(const Vehicle& vehicle, const LinearizeOptions& options);

  /// All NaN, with the names.
  [[nodiscard]] const Linearization& unsolved() const { return unsolved_; }

  /// @return  valid until the next call.  @throws InvalidInput  if A or B is not finite.
  const Linearization& at(const Vehicle& vehicle, const TrimResult& trimmed);

 private:
  Linearization unsolved_;
  Linearization result_;
  std::vector<Eigen::Index> kept_;
  Eigen::MatrixXd M_;  // x = M x_ned, the selected states only
  Eigen::MatrixXd N_;  // u = N u_ned
};

/// The same, with the trim found first.
/// @throws InvalidInput  as trim() does, too.
[[nodiscard]] Linearization linearize(const Vehicle& vehicle, const FlightCondition& condition,
                                      const LinearizeOptions& options = {},
                                      const TrimOptions& trim_options = {});

}  // namespace quadtune
