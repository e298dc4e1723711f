// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/turn_parts.hpp"
#include "quadtune/exports/firmware_filters.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Product of polynomials; coefficients in descending powers of s.
VectorXd product(const VectorXd& a, const VectorXd& b) {
  VectorXd result = VectorXd::Zero(a.size() + b.size() - 1);
  for (Index i = 0; i < a.size(); ++i) result.segment(i, b.size()) += a(i) * b;
  return result;
}
VectorXd sum(const VectorXd& a, const VectorXd& b) {
  VectorXd result = VectorXd::Zero(std::max(a.size(), b.size()));
  result.tail(a.size()) += a;
  result.tail(b.size()) += b;
  return result;
}
VectorXd power_of_s(Index n) { return VectorXd::Unit(n + 1, 0); }
VectorXd one() { return VectorXd::Ones(1); }

/// Denominator of filters whose numerators are 1.
VectorXd denominator(const internal::LowPasses& filters) {
  VectorXd result = one();
  for (const internal::LowPass& filter : filters) {
    const double w = 2 * std::numbers::pi * filter.cutoff;
    if (filter.order == 2)
      result = product(result, Eigen::Vector3d(1 / (w * w), std::numbers::sqrt2 / w, 1));
    else
      result = product(result, Eigen::Vector2d(1 / w, 1));
  }
  return result;
}

/// The filters of LoopFilters as denominators.
struct Filters {
  VectorXd gyroscope, error, target, output;
  VectorXd derivative;  ///< of D, in addition to the gyroscope's
};

Filters filters_of(const Firmware& firmware, const FirmwareLoop& loop,
                   const ParameterValues& value) {
  const internal::LoopFilters filters = internal::loop_filters(firmware, loop.axis, value);
  Filters result;
  result.gyroscope = denominator(filters.rate);
  result.error = denominator(filters.error);
  result.target = denominator(filters.target);
  result.output = denominator(filters.output);
  result.derivative = denominator(filters.derivative);
  if (loop.of_error) result.derivative = product(result.error, result.derivative);
  return result;
}

/// The speed of each rotor when all carry the same share of the weight [rad/s].
VectorXd hover_speeds(const Vehicle& vehicle) {
  const double share = vehicle.mass * vehicle.gravity / static_cast<double>(vehicle.rotors.size());
  VectorXd speeds(std::ssize(vehicle.rotors));
  for (Index i = 0; i < speeds.size(); ++i)
    speeds(i) = rotor_speed_for_thrust(vehicle.rotors[static_cast<std::size_t>(i)], share);
  return speeds;
}

/// Lead time of the torque about z relative to the rotors' speed [s]: the drag torque Q(w) and the
/// reaction J_r w' to its change give (dQ/dw + J_r s) δw.
double yaw_lead(const Vehicle& vehicle) {
  const VectorXd speeds = hover_speeds(vehicle);
  double lead = 0;
  for (Index i = 0; i < speeds.size(); ++i) {
    const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
    lead += rotor.inertia / (2 * rotor.torque_d2 * speeds(i) + rotor.torque_d1) /
            static_cast<double>(speeds.size());
  }
  return lead;
}

}  // namespace

double turn_damping(const Vehicle& vehicle, CascadeAxis axis) {
  RotorLoads<double> loads;
  const Index k = internal::body_axis(axis);
  add_airflow(RigidBody(vehicle), hover_speeds(vehicle), Eigen::Vector3d::Zero().eval(),
              Eigen::Vector3d::Unit(k).eval(), loads);
  return -loads.torque(k);
}

double firmware_delay(const Firmware& firmware, const Vehicle& vehicle,
                      const std::vector<Parameter>& values) {
  // One sample for the computation, and half a sample because the output is held.
  const ParameterValues value(firmware, values);
  return 1.5 / internal::loop_rates(firmware, value).rate + vehicle.motor.delay +
         (vehicle.sensors.gyroscope ? vehicle.sensors.gyroscope->delay : 0);
}

ContinuousTransferFunction firmware_turn_loop(const Firmware& firmware, const Vehicle& vehicle,
                                              const FirmwareLoop& loop,
                                              const std::vector<Parameter>& values, bool angle) {
  const ParameterValues value(firmware, values);
  Filters f = filters_of(firmware, loop, value);
  // τ/scale = (P + I/s) E R + FF R' + D s Fd X, each times the rate, with
  //   a = (Oo s + Oi)/s^k T     the angle loop, T the target's filter
  //   R = (1 + Od) F + a,  R' = Od F + a
  //   X = F, or F + a if D acts on the error
  const Index pi = loop.I != 0 ? 1 : 0;
  const VectorXd pi_num =
      pi == 1 ? VectorXd(Eigen::Vector2d(loop.P, loop.I)) : VectorXd::Constant(1, loop.P);
  const bool has_angle = angle && (loop.outer != 0 || loop.outer_integral != 0);
  const Index k = !has_angle ? 0 : loop.outer_integral != 0 ? 2 : 1;
  VectorXd angle_num = VectorXd::Zero(1);
  if (k == 1) angle_num(0) = loop.outer;
  if (k == 2) angle_num = Eigen::Vector2d(loop.outer, loop.outer_integral);
  if (loop.D == 0) f.derivative = one();
  if (k == 0) f.target = one();
  // Common denominator s^(pi + k) E F Fd T.
  const VectorXd from_angle = product(angle_num, f.gyroscope);
  const VectorXd from_rate = product(power_of_s(k), f.target);
  const double od = angle ? loop.outer_derivative : 0;
  const auto combined = [&](double rate) { return sum(rate * from_rate, from_angle); };
  VectorXd num = product(product(pi_num, combined(1 + od)), f.derivative);
  if (loop.D != 0)
    num = sum(num, loop.D * product(product(power_of_s(pi + 1), f.error),
                                    loop.of_error ? combined(1) : from_rate));
  if (loop.forward != 0 && angle)
    num = sum(num, loop.forward * product(product(power_of_s(pi), f.error),
                                          product(combined(od), f.derivative)));
  ContinuousTransferFunction result;
  result.num = loop.scale * num;
  if (const double lead = loop.axis == CascadeAxis::yaw ? yaw_lead(vehicle) : 0; lead > 0)
    result.num = product(result.num, Eigen::Vector2d(lead, 1));
  const double J = vehicle.inertia.diagonal()(internal::body_axis(loop.axis));
  result.den = product(product(power_of_s(pi + k), f.error), product(f.gyroscope, f.derivative));
  result.den = product(product(result.den, f.output), f.target);
  result.den = product(result.den, Eigen::Vector2d(J, turn_damping(vehicle, loop.axis)));
  if (const double lag = internal::rotor_lag(vehicle); lag > 0)
    result.den = product(result.den, Eigen::Vector2d(lag, 1));
  result.delay = firmware_delay(firmware, vehicle, values);
  return result;
}

}  // namespace quadtune
