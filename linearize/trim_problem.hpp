// SPDX-License-Identifier: Apache-2.0
/// The equations of a steady flight, which trim_newton.hpp solves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "jets.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune::internal {

/// Speed and drag torque of one rotor as functions of its thrust. Below the minimum thrust that the
/// rotor can hold, they are continued linearly, to negative thrusts as well, so that Newton's
/// method can pass through this range and report how far a trim is outside the limits.
class RotorCurve {
 public:
  /// @throws InvalidInput  if the thrust does not increase up to the maximum speed.
  RotorCurve(const Rotor& rotor, const MotorCommand& motor, double density_ratio, int number);

  /// Thrust at the rotor's minimum and maximum speed [N].
  [[nodiscard]] double min_thrust() const { return min_thrust_; }
  [[nodiscard]] double max_thrust() const { return max_thrust_; }
  [[nodiscard]] double min_speed() const { return min_speed_; }
  [[nodiscard]] double max_speed() const { return max_speed_; }
  /// Thrust at which the linear continuation begins [N]; below it, speed() is constant.
  [[nodiscard]] double continued_below() const { return join_thrust_; }

  template <class T>
  [[nodiscard]] T speed(const T& thrust) const;
  template <class T>
  [[nodiscard]] T torque(const T& thrust) const;

 private:
  Rotor rotor_;
  double density_ratio_;
  double join_speed_;  // speed at which the linear continuation begins
  double join_thrust_;
  double slope_;  // dQ/dT there
  double min_speed_, max_speed_;
  double min_thrust_, max_thrust_;
};

/// The equations of a flight with the given motion. Unknowns z: roll, pitch and the thrusts divided
/// by the weight, (2 + n).
class TrimProblem {
 public:
  TrimProblem(const Vehicle& vehicle, const FlightCondition& condition, double density_ratio);

  [[nodiscard]] Eigen::Index rotors() const { return static_cast<Eigen::Index>(curves_.size()); }
  [[nodiscard]] const std::vector<RotorCurve>& curves() const { return curves_; }
  [[nodiscard]] const RigidBody& body() const { return body_; }
  [[nodiscard]] double weight() const { return body_.mass * body_.gravity; }
  [[nodiscard]] double arm() const { return arm_; }
  [[nodiscard]] double yaw_rate() const { return yaw_rate_; }

  /// Bounds of the thrusts divided by the weight, from the motors' limits.
  [[nodiscard]] Eigen::VectorXd low() const;
  [[nodiscard]] Eigen::VectorXd high() const;

  /// The same flight with its speeds and yaw rate multiplied by `fraction`.
  [[nodiscard]] TrimProblem slowed(double fraction) const;
  /// Roll of a coordinated turn without drag, zero pitch, equal thrusts.
  [[nodiscard]] Eigen::VectorXd first_guess() const;

  /// Attitude and distribution of thrust of another trim with the same number of rotors.
  [[nodiscard]] Eigen::VectorXd guess_from(const TrimResult& neighbour) const;

  /// m v'/(m g) and J w'/(m g L), equation (6), which are zero in a trim, and the Jacobian.
  [[nodiscard]] ValueAndJacobian balance(const Eigen::VectorXd& z) const;
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::VectorXd& z) const;

  /// The 12 states at z and the rotor speeds.
  [[nodiscard]] Eigen::VectorXd state(const Eigen::VectorXd& z, double yaw) const;
  [[nodiscard]] Eigen::VectorXd speeds(const Eigen::VectorXd& z) const;

 private:
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> evaluate(const Eigen::Matrix<T, Eigen::Dynamic, 1>& z) const;

  RigidBody body_;
  std::vector<RotorCurve> curves_;
  double arm_;
  Eigen::Vector3d velocity_;  // in axes that are rotated by the heading only
  double yaw_rate_;
};

}  // namespace quadtune::internal
