// SPDX-License-Identifier: Apache-2.0
/// The equations of a steady flight and Newton's method on them; trim() judges what comes out.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "jets.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune::internal {

/// One rotor's speed and drag torque as functions of its thrust. Below the least thrust that the
/// rotor can hold they go on linearly, to negative thrusts as well, so that Newton's method can
/// pass there and tell how far outside the limits a trim lies.
class RotorCurve {
 public:
  /// @throws InvalidInput  if the thrust does not rise up to the greatest speed.
  RotorCurve(const Rotor& rotor, const MotorCommand& motor, double density_ratio, int number);

  /// Thrust at the rotor's least and greatest speed [N].
  [[nodiscard]] double least_thrust() const { return least_thrust_; }
  [[nodiscard]] double greatest_thrust() const { return greatest_thrust_; }
  [[nodiscard]] double least_speed() const { return least_speed_; }
  [[nodiscard]] double greatest_speed() const { return greatest_speed_; }

  template <class T>
  [[nodiscard]] T speed(const T& thrust) const;
  template <class T>
  [[nodiscard]] T torque(const T& thrust) const;

 private:
  Rotor rotor_;
  double density_ratio_;
  double join_speed_;  // where the line takes over
  double join_thrust_;
  double slope_;  // dQ/dT there
  double least_speed_, greatest_speed_;
  double least_thrust_, greatest_thrust_;
};

/// Roll, pitch and thrusts over the weight, (2 + n), of a flight with the given motion.
class TrimProblem {
 public:
  TrimProblem(const Vehicle& vehicle, const FlightCondition& condition, double density_ratio);

  [[nodiscard]] Eigen::Index rotors() const { return static_cast<Eigen::Index>(curves_.size()); }
  [[nodiscard]] const std::vector<RotorCurve>& curves() const { return curves_; }
  [[nodiscard]] const RigidBody& body() const { return body_; }
  [[nodiscard]] double weight() const { return body_.mass * body_.gravity; }
  [[nodiscard]] double arm() const { return arm_; }
  [[nodiscard]] double yaw_rate() const { return yaw_rate_; }

  /// Bounds of the thrusts over the weight, from the motors' limits.
  [[nodiscard]] Eigen::VectorXd low() const;
  [[nodiscard]] Eigen::VectorXd high() const;

  /// The same flight at `fraction` of its speeds and yaw rate.
  [[nodiscard]] TrimProblem slowed(double fraction) const;
  /// Roll of a coordinated turn without drag, level pitch, equal thrusts.
  [[nodiscard]] Eigen::VectorXd first_guess() const;

  /// Attitude and shares of thrust of another trim, of as many rotors.
  [[nodiscard]] Eigen::VectorXd guess_from(const TrimResult& neighbour) const;

  /// m v'/(m g) and J w'/(m g L), (6), zero in a trim, with the Jacobian.
  [[nodiscard]] ValueAndJacobian balance(const Eigen::VectorXd& z) const;
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::VectorXd& z) const;

  /// The 12 states at z, and the rotor speeds.
  [[nodiscard]] Eigen::VectorXd state(const Eigen::VectorXd& z, double yaw) const;
  [[nodiscard]] Eigen::VectorXd speeds(const Eigen::VectorXd& z) const;

 private:
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> evaluate(const Eigen::Matrix<T, Eigen::Dynamic, 1>& z) const;

  RigidBody body_;
  std::vector<RotorCurve> curves_;
  double arm_;
  Eigen::Vector3d velocity_;  // in axes turned with the heading only
  double yaw_rate_;
};

/// Where Newton's method came to.
struct NewtonResult {
  Eigen::VectorXd z;
  double residual = 0;  ///< largest entry of the balance
  int iterations = 0;
  Eigen::Index freedom = 0;  ///< of the thrusts, beyond the four that the balance fixes
};

/// Newton's method from z; among the thrusts that balance it takes those of least sum of squares.
/// @param within_limits  bounds the thrusts of every step by the motors' limits.
[[nodiscard]] NewtonResult newton(const TrimProblem& problem, Eigen::VectorXd z,
                                  const TrimOptions& options, bool within_limits);

}  // namespace quadtune::internal
