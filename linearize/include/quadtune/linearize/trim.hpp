// SPDX-License-Identifier: Apache-2.0
/// Steady flights: the attitude and rotor speeds at which a vehicle hovers, flies straight, circles
/// or spins in place within its motors' limits. Method: docs/theory.md, "Trim and linearization".
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/flight_condition.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// The outcome of the computation of a trim.
enum class TrimStatus {
  not_run,
  solved,
  not_enough_thrust,  ///< all rotors at maximum speed do not produce enough thrust
  rotor_too_fast,     ///< the thrust is sufficient, but one rotor would have to exceed its limit
  /// One rotor would have to turn below its minimum speed, or produce negative thrust.
  rotor_too_slow,
  no_authority,    ///< a torque remains for every distribution of thrust among the rotors
  no_convergence,  ///< none of the above, and Newton's method did not converge
};

/// "solved", "not enough thrust", …
[[nodiscard]] std::string to_string(TrimStatus status);

/// Numerical options of the computation, and the air density.
struct TrimOptions {
  double density_ratio = 1;  ///< air density over the vehicle's, > 0
  double tolerance = 1e-10;  ///< on TrimResult::residual, > 0
  int max_iterations = 100;  ///< Newton steps of one search, ≥ 1; five are typical
};

/// A steady flight with its evidence, or the reason why none was found.
struct TrimResult {
  TrimStatus status = TrimStatus::not_run;  ///< solved, or the reason why there is no trim
  FlightCondition condition;                ///< as requested
  double density_ratio = 1;                 ///< as requested
  /// (12) state of ned_convention() with the position at the origin; NaN unless solved.
  Eigen::VectorXd x;
  Eigen::VectorXd u;       ///< (n) rotor speeds [rad/s]; NaN unless solved
  Eigen::VectorXd thrust;  ///< (n) rotor thrusts [N]; NaN unless solved
  /// Rate of the heading [rad/s]: speed/radius in a circle, as requested in a spin.
  double yaw_rate = 0;
  /// Maximum of |m v'|/(m g) and |J w'|/(m g L), with L the longest arm: the remaining imbalance.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Angle between body -z and the vertical [rad]; NaN unless solved.
  double tilt = std::numeric_limits<double>::quiet_NaN();
  /// Total thrust at maximum rotor speeds divided by the weight, whatever the status.
  double thrust_to_weight = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;   ///< total number of Newton steps
  std::string culprit;  ///< what is missing, and by how much; empty if solved

  /// Whether there is a trim.
  [[nodiscard]] bool solved() const { return status == TrimStatus::solved; }
};

/// Computes the roll, pitch and rotor speeds that keep the body velocity and rates of `condition`
/// steady.
///
/// With more than four rotors, the thrusts have the least sum of squares, that is they are as equal
/// as the balance and the limits permit. A rotor counts as stopped below a thousandth of its
/// maximum speed.
///
/// @param vehicle    mass, gravity > 0; 1..16 rotors; it need not be able to fly.
/// @param condition  speed ≥ 0; radius ≠ 0 and speed > 0 in a circle; yaw_rate ≠ 0 in a spin;
///                   fields that do not belong to its kind are 0.
/// @param options    tolerance, number of steps, and the density of the air
/// @param neighbour  a nearby trim, or nullptr: used as initial guess if its residual is smaller
///                   than that of the default guess. The same trim is found, up to rounding, in
///                   fewer steps.
/// @throws InvalidInput  with the field, its value and the expected range.
[[nodiscard]] TrimResult trim(const Vehicle& vehicle, const FlightCondition& condition,
                              const TrimOptions& options = {},
                              const TrimResult* neighbour = nullptr);

}  // namespace quadtune
