// SPDX-License-Identifier: Apache-2.0
/// Vehicles for which the gains of autopilots are known in SI units.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::testing {

/// Four rotors in X at (±x, ±y) m, from the front left clockwise, whose thrust is a2 w² + a1 w and
/// whose drag torque is c times that. The motors' command is 0 … 1.
inline Vehicle firmware_vehicle(double mass, const Eigen::Vector3d& inertia, double x, double y,
                                double a2, double a1, double c, CommandLaw law) {
  Vehicle vehicle;
  vehicle.name = "case";
  vehicle.mass = mass;
  vehicle.inertia = inertia.asDiagonal();
  vehicle.gravity = 9.80665;
  vehicle.motor.law = law;
  vehicle.motor.max = 1;
  const std::pair<double, double> places[] = {{x, -y}, {x, y}, {-x, y}, {-x, -y}};
  for (int i = 0; i < 4; ++i) {
    Rotor rotor;
    rotor.position = {places[i].first, places[i].second, 0};
    rotor.spin = i % 2 == 0 ? Spin::clockwise : Spin::counter_clockwise;
    rotor.thrust_a2 = a2;
    rotor.thrust_a1 = a1;
    rotor.torque_d2 = c * a2;
    rotor.torque_d1 = c * a1;
    vehicle.rotors.push_back(rotor);
  }
  return vehicle;
}

/// PX4's own simulator SIH: 5 N of thrust and 0.1 N m of torque per motor, in proportion to the
/// command.
inline Vehicle sih_vehicle() {
  Vehicle vehicle =
      firmware_vehicle(1, {0.025, 0.025, 0.030}, 0.2, 0.2, 5, 0, 0.02, CommandLaw::speed_squared);
  for (Rotor& rotor : vehicle.rotors) rotor.lag = 0.05;
  return vehicle;
}

/// Gazebo's iris, whose rotors are not where its parameters state.
inline Vehicle iris_vehicle() {
  Vehicle vehicle = firmware_vehicle(1.55, {0.0300196, 0.0294736, 0.056447}, 0.13, 0.22, 5.84e-6, 0,
                                     0.06, CommandLaw::speed);
  vehicle.motor.min = 100;
  vehicle.motor.max = 1100;
  vehicle.rotors[2].position = {-0.13, 0.20, 0};
  vehicle.rotors[3].position = {-0.13, -0.20, 0};
  return vehicle;
}

/// ArduPilot's SITL frame: hover at 0.39, expo 0.65.
inline Vehicle arducopter_vehicle() {
  const double full = 3 * 9.80665 / (4 * 0.39);
  return firmware_vehicle(3, {0.02296875, 0.02296875, 0.0459375}, 0.247487, 0.247487, 0.65 * full,
                          0.35 * full, 0.02, CommandLaw::speed);
}

/// The racing quadrotor that circulates with agilicious.
inline Vehicle racing_vehicle(CommandLaw law) {
  Vehicle vehicle =
      firmware_vehicle(0.752, {0.0025, 0.0021, 0.0043}, 0.075, 0.10, 8.5, 0, 0.022, law);
  vehicle.gravity = 9.81;
  return vehicle;
}

/// A Crazyflie 2.1+ with the parameters of its firmware.
inline Vehicle crazyflie_vehicle() {
  const double a = 0.046 / std::sqrt(2.0);
  Vehicle vehicle = firmware_vehicle(0.029, {16.571710e-6, 16.655602e-6, 29.261652e-6}, a, a, 0.12,
                                     0, 0.00699289490, CommandLaw::speed_squared);
  vehicle.gravity = 9.81;
  return vehicle;
}

/// A cascade from the sizes of its gains, {Kp, Ki, Kd}, with the signs of PidLoop.
inline CascadeGains firmware_cascade(const std::vector<Eigen::Vector3d>& sizes) {
  CascadeGains gains;
  gains.dt = 0.0025;
  for (const CascadeAxis axis : kAllCascadeAxes) {
    const double sign = axis == CascadeAxis::x ? -1 : 1;
    const Eigen::Vector3d& size = sizes[index_of(axis)];
    PidLoop loop = cascade_loop(axis);
    loop.Kp = sign * size(0);
    loop.Ki = sign * size(1);
    loop.Kd = -sign * size(2);
    gains.loops.push_back(loop);
  }
  return gains;
}

/// Gains that every firmware can fly: Kp² = 5 |Kd| Ki.
inline CascadeGains usual_firmware_cascade() {
  return firmware_cascade({{0.18, 0.0385, 0.1684},
                           {0.18, 0.0385, 0.1684},
                           {3.0, 5.142857, 0.35},
                           {3.0, 5.142857, 0.35},
                           {0.4, 0.16, 0.2},
                           {8, 2.56, 5}});
}

}  // namespace quadtune::testing
