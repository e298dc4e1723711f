// SPDX-License-Identifier: Apache-2.0
#include "trim_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

// A rotor below this fraction of its maximum speed counts as stopped.
constexpr double kStandingSpeed = 1e-3;
// A thrust curve with a1 < 0 starts at -a1/a2; the linear continuation begins slightly above.
constexpr double kAboveZeroThrust = 1.05;

double longest_arm(const Vehicle& vehicle) {
  double arm = 0;
  for (const Rotor& rotor : vehicle.rotors) arm = std::max(arm, rotor.position.head<2>().norm());
  return arm > 0 ? arm : 1;  // rotors all on the axis: torques per metre
}

double yaw_rate_of(const FlightCondition& condition) {
  return condition.kind == FlightKind::circle ? condition.speed / condition.radius
                                              : condition.yaw_rate;
}

}  // namespace

RotorCurve::RotorCurve(const Rotor& rotor, const MotorCommand& motor, double density_ratio,
                       int number)
    : rotor_(rotor), density_ratio_(density_ratio) {
  max_speed_ = speed_of_command(motor, motor.max);
  max_thrust_ = rotor_thrust(rotor, max_speed_, density_ratio);
  join_speed_ = kStandingSpeed * max_speed_;
  if (rotor.thrust_a1 < 0)
    join_speed_ = std::max(join_speed_, -kAboveZeroThrust * rotor.thrust_a1 / rotor.thrust_a2);
  if (!(rotor.thrust_a2 >= 0) || !(max_thrust_ > 0) || !std::isfinite(max_thrust_) ||
      !(join_speed_ < max_speed_))
    throw InvalidInput(
        fmt::format("rotor {}", number),
        fmt::format("thrust {} w² + {} w is {} N at the maximum speed of {} rad/s, expected a "
                    "thrust that increases up to that speed",
                    rotor.thrust_a2, rotor.thrust_a1, max_thrust_, max_speed_));
  join_thrust_ = rotor_thrust(rotor, join_speed_, density_ratio);
  slope_ = (2 * rotor.torque_d2 * join_speed_ + rotor.torque_d1) /
           (2 * rotor.thrust_a2 * join_speed_ + rotor.thrust_a1);
  min_speed_ = std::max(join_speed_, speed_of_command(motor, motor.min));
  min_thrust_ = rotor_thrust(rotor, min_speed_, density_ratio);
}

template <class T>
T RotorCurve::speed(const T& thrust) const {
  using std::sqrt;
  if (thrust <= T(join_thrust_)) return T(join_speed_);
  // The larger root of a2 w² + a1 w = T, in the form without cancellation.
  const T F = thrust / density_ratio_;
  const double a1 = rotor_.thrust_a1, a2 = rotor_.thrust_a2;
  const T root = sqrt(a1 * a1 + 4 * a2 * F);
  return a1 > 0 ? T(2.0 * F / (a1 + root)) : T((root - a1) / (2 * a2));
}

template <class T>
T RotorCurve::torque(const T& thrust) const {
  const T at_speed(rotor_torque(rotor_, speed(thrust), density_ratio_));
  return thrust <= T(join_thrust_) ? T(at_speed + slope_ * (thrust - join_thrust_)) : at_speed;
}

template double RotorCurve::speed(const double&) const;
template double RotorCurve::torque(const double&) const;

TrimProblem::TrimProblem(const Vehicle& vehicle, const FlightCondition& condition,
                         double density_ratio)
    : body_(vehicle, density_ratio),
      arm_(longest_arm(vehicle)),
      velocity_(condition.speed, 0, -condition.climb),
      yaw_rate_(yaw_rate_of(condition)) {
  int number = 0;
  for (const Rotor& rotor : vehicle.rotors)
    curves_.emplace_back(rotor, vehicle.motor, density_ratio, ++number);
}

Eigen::VectorXd TrimProblem::low() const {
  Eigen::VectorXd f(rotors());
  for (Eigen::Index i = 0; i < f.size(); ++i)
    f(i) = curves_[static_cast<std::size_t>(i)].min_thrust() / weight();
  return f;
}

Eigen::VectorXd TrimProblem::high() const {
  Eigen::VectorXd f(rotors());
  for (Eigen::Index i = 0; i < f.size(); ++i)
    f(i) = curves_[static_cast<std::size_t>(i)].max_thrust() / weight();
  return f;
}

TrimProblem TrimProblem::slowed(double fraction) const {
  TrimProblem slower = *this;
  slower.velocity_ *= fraction;
  slower.yaw_rate_ *= fraction;
  return slower;
}

Eigen::VectorXd TrimProblem::first_guess() const {
  Eigen::VectorXd z(2 + rotors());
  z(0) = std::atan(velocity_.x() * yaw_rate_ / body_.gravity);  // tan(roll) = V ψ' / g
  z(1) = 0;
  z.tail(rotors()).setConstant(1 / (std::cos(z(0)) * static_cast<double>(rotors())));
  return z;
}

Eigen::VectorXd TrimProblem::guess_from(const TrimResult& neighbour) const {
  Eigen::VectorXd z(2 + rotors());
  z.head<2>() = neighbour.x.segment<2>(kAttitude);
  // The neighbour's distribution of thrust, scaled to carry this weight at that attitude.
  z.tail(rotors()) = neighbour.thrust / (neighbour.thrust.sum() * std::cos(z(0)) * std::cos(z(1)));
  return z;
}

template <class T>
Eigen::Matrix<T, 6, 1> TrimProblem::evaluate(const Eigen::Matrix<T, Eigen::Dynamic, 1>& z) const {
  const T &roll = z(0), &pitch = z(1);
  const Matrix3<T> R = rotation_of_euler(roll, pitch, T(0));
  const Vector3<T> velocity = R.transpose() * velocity_.cast<T>();
  const Vector3<T> rates = body_rate_matrix(roll, pitch) * Vector3<T>(T(0), T(0), T(yaw_rate_));
  RotorLoads<T> loads;
  RotorSpeeds<T> speeds(rotors());
  for (Eigen::Index i = 0; i < rotors(); ++i) {
    const RotorCurve& curve = curves_[static_cast<std::size_t>(i)];
    const T thrust = z(2 + i) * T(weight());
    speeds(i) = curve.speed(thrust);
    add_rotor(body_.rotors[static_cast<std::size_t>(i)], thrust, curve.torque(thrust), speeds(i),
              loads);
  }
  if (body_.has_airflow) add_airflow(body_, speeds, velocity, rates, loads);
  const Vector3<T> down = R.row(2).transpose();
  Eigen::Matrix<T, 6, 1> balance;
  balance << linear_acceleration(body_, down, velocity, rates, loads.force, velocity) *
                 T(1 / body_.gravity),
      net_torque(body_, rates, loads) * T(1 / (weight() * arm_));
  return balance;
}

ValueAndJacobian TrimProblem::balance(const Eigen::VectorXd& z) const {
  return differentiate([this](const JetVector& zj) { return evaluate<Jet>(zj); }, z, 6);
}

Eigen::VectorXd TrimProblem::residual(const Eigen::VectorXd& z) const {
  return evaluate<double>(z);
}

Eigen::VectorXd TrimProblem::state(const Eigen::VectorXd& z, double yaw) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(12);
  x.segment<3>(kAttitude) << z(0), z(1), yaw;
  x.segment<3>(kVelocity) = rotation_of_euler(z(0), z(1), 0.0).transpose() * velocity_;
  x.segment<3>(kRates) = body_rate_matrix(z(0), z(1)) * Eigen::Vector3d(0, 0, yaw_rate_);
  return x;
}

Eigen::VectorXd TrimProblem::speeds(const Eigen::VectorXd& z) const {
  Eigen::VectorXd w(rotors());
  for (Eigen::Index i = 0; i < w.size(); ++i)
    w(i) = curves_[static_cast<std::size_t>(i)].speed(z(2 + i) * weight());
  return w;
}

}  // namespace quadtune::internal
