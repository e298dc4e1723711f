// SPDX-License-Identifier: Apache-2.0
/// Vehicles made in memory, for tests of the physics that need no vehicle file.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "quadtune/model/vehicle.hpp"

namespace quadtune::testing {

/// The parameters of the public uquad project: rotors 1 front, 2 left, 3 back, 4 right; 1 and 3
/// turn counter-clockwise.
[[nodiscard]] inline Vehicle plus_quadrotor() {
  Vehicle vehicle;
  vehicle.name = "plus";
  vehicle.mass = 1.741;
  vehicle.inertia = Eigen::Vector3d(2.32e-2, 2.32e-2, 4.37e-2).asDiagonal();
  for (int i = 0; i < 4; ++i) {
    Rotor rotor;
    const double angle = -i * std::numbers::pi / 2;  // forward, left, back, right
    rotor.position = {std::round(std::cos(angle)) * 0.29, std::round(std::sin(angle)) * 0.29, 0};
    rotor.spin = i % 2 ? Spin::clockwise : Spin::counter_clockwise;
    rotor.thrust_a2 = 4.60160135072435e-5;
    rotor.thrust_a1 = -0.00103822726273726;
    rotor.torque_d2 = 3.4734e-6;
    rotor.torque_d1 = -1.3205e-4;
    rotor.inertia = 1.54e-5;
    vehicle.rotors.push_back(rotor);
  }
  vehicle.motor.min = 109;
  vehicle.motor.max = 387;
  return vehicle;
}

/// A flyable vehicle with `rotors` (even, ≥ 4) rotors around a circle, which turn alternately, with
/// slightly irregular arms, heights and curves, full inertia and drag.
[[nodiscard]] inline Vehicle random_vehicle(std::mt19937_64& random, int rotors) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Vehicle vehicle;
  vehicle.name = "random";
  vehicle.mass = between(0.5, 3.0);
  const double arm = between(0.15, 0.4);
  const double jx = 0.02 * vehicle.mass * arm;
  Eigen::Matrix3d skew;
  for (int i = 0; i < 9; ++i) skew(i / 3, i % 3) = between(-0.1, 0.1);
  const Eigen::Matrix3d root = Eigen::Matrix3d::Identity() + skew;
  vehicle.inertia = root * Eigen::Vector3d(jx, 1.2 * jx, 1.9 * jx).asDiagonal() * root.transpose();
  const double hover_thrust = vehicle.mass * 9.81 / rotors;
  const double a2 = hover_thrust / (500.0 * 500.0);  // about 500 rad/s at hover
  const double offset = between(-0.3, 0.3);
  for (int i = 0; i < rotors; ++i) {
    Rotor rotor;
    const double angle = 2 * std::numbers::pi * (i + 0.5) / rotors + offset;
    const double length = arm * between(0.95, 1.05);
    rotor.position = {length * std::cos(angle), length * std::sin(angle), between(-0.03, 0.03)};
    rotor.spin = i % 2 ? Spin::clockwise : Spin::counter_clockwise;
    rotor.thrust_a2 = a2 * between(0.98, 1.02);
    rotor.thrust_a1 = a2 * between(-5, 5);
    rotor.torque_d2 = 0.02 * rotor.thrust_a2;
    rotor.torque_d1 = 0.02 * rotor.thrust_a1;
    rotor.inertia = between(0, 1e-4) * jx;
    vehicle.rotors.push_back(rotor);
  }
  vehicle.motor.min = 50;
  vehicle.motor.max = 1000;
  vehicle.drag.cda = {between(0, 0.02), between(0, 0.02), between(0, 0.04)};
  vehicle.drag.linear = {between(0, 0.1), between(0, 0.1), between(0, 0.1)};
  return vehicle;
}

/// A state of moderate attitude (|roll|, |pitch| < 1 rad), speed and rate.
[[nodiscard]] inline Eigen::Matrix<double, 12, 1> random_state(std::mt19937_64& random) {
  Eigen::Matrix<double, 12, 1> x;
  for (int i = 0; i < 12; ++i) x(i) = std::uniform_real_distribution<double>(-1, 1)(random);
  x.segment<3>(6) *= 5;
  x.tail<3>() *= 3;
  return x;
}

}  // namespace quadtune::testing
