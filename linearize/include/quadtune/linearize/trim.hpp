// SPDX-License-Identifier: Apache-2.0
/// Steady flights: the attitude and rotor speeds at which a vehicle hovers, flies straight,
/// circles or turns on the spot, within its motors' limits. Method: docs/theory.md, "Trim and
/// linearization".
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/flight_condition.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// How the search for a trim ended.
enum class TrimStatus {
  not_run,
  solved,
  not_enough_thrust,  ///< all rotors at their greatest speed do not give the thrust
  rotor_too_fast,     ///< the thrust is there, but one rotor would have to exceed the limit
  rotor_too_slow,     ///< one rotor would have to turn below its least speed, or push down
  no_authority,       ///< the rotors leave a torque that no sharing of thrust removes
  no_convergence,     ///< none of the above, and Newton's method did not get there
};

/// "solved", "not enough thrust", …
[[nodiscard]] std::string to_string(TrimStatus status);

/// How hard the search tries and in which air.
struct TrimOptions {
  double density_ratio = 1;  ///< air density over the vehicle's, > 0
  double tolerance = 1e-10;  ///< on TrimResult::residual, > 0
  int max_iterations = 100;  ///< Newton steps of one search, ≥ 1; five are typical
};

/// A steady flight together with the evidence, or the reason why there is none.
struct TrimResult {
  TrimStatus status = TrimStatus::not_run;
  FlightCondition condition;  ///< as asked for
  double density_ratio = 1;   ///< as asked for
  Eigen::VectorXd x;          ///< (12) state of ned_convention() at the origin; NaN unless solved
  Eigen::VectorXd u;          ///< (n) rotor speeds [rad/s]; NaN unless solved
  Eigen::VectorXd thrust;     ///< (n) rotor thrusts [N]; NaN unless solved
  double yaw_rate = 0;  ///< of the heading [rad/s]: speed/radius in a circle, as asked in a spin
  /// Greatest of |m v'|/(m g) and |J w'|/(m g L), L the longest arm: what is left unbalanced.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Angle between body -z and the vertical [rad]; NaN unless solved.
  double tilt = std::numeric_limits<double>::quiet_NaN();
  /// Thrust of all rotors at their greatest speed over the weight, whatever the status.
  double thrust_to_weight = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;   ///< Newton steps, all searches together
  std::string culprit;  ///< what is missing and by how much; empty when solved

  [[nodiscard]] bool solved() const { return status == TrimStatus::solved; }
};

/// Finds roll, pitch and rotor speeds that keep the body velocity and rates of `condition` steady.
///
/// With more than four rotors the thrusts of least sum of squares are taken, that is as equal as
/// the balance and the limits let them be. A rotor counts as stopped below a thousandth of its
/// greatest speed.
///
/// @param vehicle    mass, gravity > 0; 1..16 rotors; need not be able to fly.
/// @param condition  speed ≥ 0; radius ≠ 0 and speed > 0 in a circle; yaw_rate ≠ 0 in a spin;
/// fields
///                   that do not belong to its kind are 0.
/// @param neighbour  a trim near by, or nullptr: the search starts there if that balances better
/// than
///                   the first guess. It finds the same trim, to rounding, in fewer steps.
/// @throws InvalidInput  naming the field, what came and what was expected.
[[nodiscard]] TrimResult trim(const Vehicle& vehicle, const FlightCondition& condition,
                              const TrimOptions& options = {},
                              const TrimResult* neighbour = nullptr);

}  // namespace quadtune
