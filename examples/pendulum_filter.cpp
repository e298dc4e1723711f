// SPDX-License-Identifier: Apache-2.0
/// A filter for a model of your own: the angle and the rate of a pendulum, of which a camera sees
/// the sideways position. The filter computes the Jacobians of the model itself.
/// Exit status: 0 if the filter is consistent, 1 if not, 2 and one line for any error.
#include <cmath>
#include <exception>
#include <iostream>
#include <quadtune/estimation/extended_kalman_filter.hpp>
#include <random>

namespace {

using quadtune::ModelVector;

constexpr double kGravity = 9.81, kLength = 0.7;  // [m/s²], [m]

// x = (angle [rad], rate [rad/s]) after dt seconds. T is double or carries derivatives.
const auto swing = []<class T>(const ModelVector<T>& x, double torque, double dt) {
  using std::sin;  // sin(x) then means that of T
  const T rate = x(1) + dt * (torque - kGravity / kLength * sin(x(0)));
  return ModelVector<T>{{x(0) + dt * rate, rate}};
};

// What the camera measures [m].
const auto sideways = []<class T>(const ModelVector<T>& x, double /*torque*/) {
  using std::sin;
  return T(kLength * sin(x(0)));
};

}  // namespace

int main() {
  try {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    const double dt = 0.01, noise = 0.005, push = 0.02;  // [s], [m], [rad/s] per step
    const int steps = 2000;
    const Eigen::MatrixXd Q = Eigen::Vector2d(0, push * push).asDiagonal();
    const Eigen::MatrixXd R = Eigen::MatrixXd::Constant(1, 1, noise * noise);
    ModelVector<double> truth{{0.5, 0.0}};
    quadtune::ExtendedKalmanFilter filter(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity());
    double squares = 0, error = 0;
    for (int k = 0; k < steps; ++k) {
      const double torque = std::sin(0.02 * k);
      truth = swing(truth, torque, dt);
      truth(1) += push * normal(random);
      const ModelVector<double> y{{sideways(truth, torque) + noise * normal(random)}};
      filter.predict(swing, torque, dt, Q);
      squares += filter.update(sideways, torque, y, R).innovation_square;
      error += std::pow(filter.x()(0) - truth(0), 2);
    }
    // e²/S has the mean 1 if Q and R are right, with a deviation of sqrt(2/steps).
    std::cout << "angle estimated within " << std::sqrt(error / steps)
              << " rad (rms)\nmean of e^2/S: " << squares / steps << '\n';
    return std::abs(squares / steps - 1) < 3 * std::sqrt(2.0 / steps) ? 0 : 1;
  } catch (const std::exception& problem) {
    std::cerr << "pendulum_filter: " << problem.what() << '\n';
    return 2;
  }
}
