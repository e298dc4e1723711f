// SPDX-License-Identifier: Apache-2.0
/// Laws of every kind that flight code is exported with.
#pragma once

#include <string>

#include "quadtune/control/allocation.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/model/environment.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune::testing {

/// Gains that stabilize a vehicle at hover: damped angles, slow position. Not optimal, but with all
/// terms of the law that the case requires.
inline Gains hovering_feedback(const Vehicle& vehicle, InputKind kind, int past, bool integrals) {
  const Allocation<double> law = allocation(vehicle);
  const auto& J = vehicle.inertia;
  Gains gains;
  gains.vehicle = vehicle.name;
  gains.convention = "ned";
  gains.states = ned_convention().states;
  gains.dt = 0.005;
  gains.x0 = Eigen::VectorXd::Zero(12);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(4, 12), K_int = Eigen::MatrixXd::Zero(4, 4);
  const double m = vehicle.mass, g = vehicle.gravity;
  const double angle = 60, rate = 12;  // of a damped angle [1/s², 1/s]
  K(0, 2) = -6 * m;
  K(0, 8) = -4 * m;
  K(1, 3) = J(0, 0) * angle;
  K(1, 9) = J(0, 0) * rate;
  K(1, 1) = J(0, 0) * angle * 0.8 / g;
  K(1, 7) = J(0, 0) * angle * 1.6 / g;
  K(2, 4) = J(1, 1) * angle;
  K(2, 10) = J(1, 1) * rate;
  K(2, 0) = -J(1, 1) * angle * 0.8 / g;
  K(2, 6) = -J(1, 1) * angle * 1.6 / g;
  K(3, 5) = J(2, 2) * 4;
  K(3, 11) = J(2, 2) * 4;
  K_int(1, 1) = K(1, 1) * 0.1;
  K_int(2, 0) = K(2, 0) * 0.1;
  K_int(0, 2) = K(0, 2) * 0.2;
  K_int(3, 3) = K(3, 5) * 0.1;
  const int rotors = law.rotors;
  Eigen::MatrixXd to = Eigen::MatrixXd::Identity(4, 4);
  gains.u0 = law.wrench0;
  if (kind != InputKind::wrench) {
    to = law.P.topRows(rotors);
    gains.u0 = law.thrust0;
    for (int i = 0; i < rotors && kind != InputKind::rotor_thrust; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double speed = speed_for_thrust(law.thrust0(i), law.a2[k], law.a1[k]);
      to.row(i) /= 2 * law.a2[k] * speed + law.a1[k];
      gains.u0(i) = speed;
      if (kind != InputKind::command) continue;
      // As the motors are driven: command = speed/gain, or speed²/gain.
      const bool squared = vehicle.motor.law == CommandLaw::speed_squared;
      to.row(i) *= (squared ? 2 * speed : 1.0) / vehicle.motor.gain;
      gains.u0(i) = (squared ? speed * speed : speed) / vehicle.motor.gain;
    }
  }
  gains.K = to * K;
  gains.input_kind = kind;
  gains.inputs = input_signals(ned_convention(), kind, rotors, "test");
  gains.K_int = Eigen::MatrixXd(gains.K.rows(), 0);
  if (integrals) {
    gains.K_int = to * K_int;
    gains.integrals = integral_signals(gains.states, {"px", "py", "pz", "yaw"});
  }
  gains.axes = PositionAxes::heading;
  gains.limits = {0.6, true};
  if (past >= 0) {
    const Eigen::Index n = gains.K.rows();
    gains.memory =
        CommandMemory{Eigen::VectorXd::Constant(n, 0.04), Eigen::MatrixXd::Identity(n, n) * 0.05,
                      past, Eigen::MatrixXd::Constant(n, n * past, 0.001)};
  }
  return gains;
}

/// Likewise a cascade with all its terms.
inline CascadeDesign hovering_cascade(const Vehicle& vehicle, PidMethod method) {
  const auto& J = vehicle.inertia;
  CascadeDesign design;
  design.gains.dt = 0.005;
  const auto loop = [&](const char* name, double Kp, double Ki, double Kd) {
    PidLoop made = cascade_loop(cascade_axis(name, "test"));
    made.Kp = Kp;
    made.Ki = Ki;
    made.Kd = Kd;
    design.gains.loops.push_back(made);
  };
  loop("x", -0.08, -0.004, 0.16);
  loop("y", 0.08, 0.004, -0.16);
  loop("pitch", J(1, 1) * 60, J(1, 1) * 6, -J(1, 1) * 12);
  loop("roll", J(0, 0) * 60, J(0, 0) * 6, -J(0, 0) * 12);
  loop("yaw", J(2, 2) * 4, J(2, 2) * 0.4, -J(2, 2) * 4);
  loop("altitude", vehicle.mass * 6, vehicle.mass * 1.5, -vehicle.mass * 4);
  design.method = method;
  design.attitude_limit = 0.4;
  design.integrator_limit = 2;
  design.conditional_integration = true;
  design.velocity_feed_forward = true;
  return design;
}

/// Steady-state filters whose matrices have every shape; the second has correlated noises, so that
/// L is not A M, and no inputs.
inline std::vector<KalmanFilter> steady_filters() {
  KalmanFilter height;
  height.name = "height";
  height.model.A = Eigen::MatrixXd{{1, 0.005}, {0, 1}};
  height.model.B = Eigen::MatrixXd{{0}, {0.005}};
  height.model.C = Eigen::MatrixXd{{1, 0}};
  height.model.dt = 0.005;
  height.model.states = {{"z", "m"}, {"vz", "m/s"}};
  height.model.inputs = {{"az", "m/s^2"}};
  height.model.outputs = {{"z_sonar", "m"}};
  height.R = Eigen::MatrixXd{{0.1}};
  height.M = Eigen::MatrixXd{{0.0262414206418703}, {0.0697767360714920}};
  height.L = height.model.A * height.M;
  KalmanFilter other;
  other.name = "a */ name";
  other.model.A = Eigen::MatrixXd{{0.9, 0.1, 0}, {-0.1, 0.8, 0.05}, {0, 0, 0.7}};
  other.model.B = Eigen::MatrixXd(3, 0);
  other.model.C = Eigen::MatrixXd{{1, 0, 0}, {0, 1, 1}};
  other.model.dt = 0.02;
  other.model.states = {{"a", ""}, {"b", ""}, {"c", "rad"}};
  other.model.outputs = {{"ya", ""}, {"yb", ""}};
  other.R = Eigen::MatrixXd{{0.2, 0.05}, {0.05, 0.3}};
  other.M = Eigen::MatrixXd{{0.3, 0.01}, {0.02, 0.2}, {0, 0.1}};
  other.L = Eigen::MatrixXd{{0.25, 0.03}, {-0.01, 0.15}, {0.01, 0.05}};
  for (KalmanFilter* filter : {&height, &other}) {
    const Eigen::Index states = filter->model.A.rows();
    filter->G = filter->Q = filter->P = filter->Z = Eigen::MatrixXd::Identity(states, states);
    filter->N = Eigen::MatrixXd::Zero(states, filter->model.C.rows());
  }
  return {height, other};
}

/// A kind of exported flight code.
struct FlightCodeCase {
  std::string name;
  std::string vehicle;
  InputKind kind = InputKind::wrench;
  int past = -1;  ///< no memory
  bool integrals = true;
  bool cascade = false;
  bool estimator = true;
  bool double_precision = false;
  std::string filter = "general";  ///< or "mambo" or "uquad", where there is an estimator
  bool steady_filters = false;     ///< whether the design has Kalman filters
  bool rate_lead = false;          ///< whether roll and pitch act on the derivative of the rate
};

inline ExportContent flight_code_content(const FlightCodeCase& of) {
  ExportContent content;
  content.vehicle = load_vehicle(of.vehicle);
  if (of.cascade)
    content.cascade = hovering_cascade(content.vehicle, PidMethod::tustin);
  else
    content.gains = hovering_feedback(content.vehicle, of.kind, of.past, of.integrals);
  if (of.rate_lead)
    for (PidLoop& loop : content.cascade->gains.loops)
      if (loop.name == "pitch" || loop.name == "roll") {
        loop.rate_lead = 0.02;
        loop.rate_filter = 0.0053;
      }
  if (of.estimator && of.filter != "general") content.estimator = StoredEstimator{of.filter};
  if (of.estimator && of.filter == "general")
    content.estimator = StoredEstimator{
        "general", general_filter_settings(content.vehicle.sensors, 0.005, content.vehicle.gravity,
                                           Environment{}.magnetic_field, GeneralFilterNoise{})};
  if (of.steady_filters) content.filters = steady_filters();
  content.flight_code.double_precision = of.double_precision;
  return content;
}

}  // namespace quadtune::testing
