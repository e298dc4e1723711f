// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/turn_parts.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Coefficients in descending powers of s.
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

/// Denominator of a low pass whose numerator is 1; 1 where the cut-off is 0, off.
VectorXd first_order(double cutoff_Hz) {
  if (!(cutoff_Hz > 0)) return one();
  return Eigen::Vector2d(1 / (2 * std::numbers::pi * cutoff_Hz), 1);
}
VectorXd butterworth(double cutoff_Hz) {
  if (!(cutoff_Hz > 0)) return one();
  const double w = 2 * std::numbers::pi * cutoff_Hz;
  return Eigen::Vector3d(1 / (w * w), std::numbers::sqrt2 / w, 1);
}

/// What a firmware does to its rates, as denominators.
struct Filters {
  VectorXd gyroscope = one();
  VectorXd derivative = one();  ///< of D, beside the gyroscope's
  VectorXd error = one();       ///< of the error of P and I
  VectorXd target = one();      ///< of what the loop of the angle asks for
  VectorXd output = one();
};

Filters filters_of(const Firmware& firmware, CascadeAxis axis, const ParameterValues& value) {
  Filters filters;
  const bool yaw = axis == CascadeAxis::yaw;
  switch (firmware.kind) {
    case FirmwareKind::px4:
      filters.gyroscope = butterworth(value("IMU_GYRO_CUTOFF"));
      filters.derivative = first_order(value("IMU_DGYRO_CUTOFF"));
      if (yaw && value.has("MC_YAW_TQ_CUTOFF"))
        filters.output = first_order(value("MC_YAW_TQ_CUTOFF"));
      break;
    case FirmwareKind::ardupilot: {
      const std::string rate = std::string("ATC_RAT_") +
                               (yaw                         ? "YAW"
                                : axis == CascadeAxis::roll ? "RLL"
                                                            : "PIT") +
                               "_";
      filters.gyroscope = butterworth(value("INS_GYRO_FILTER"));
      filters.error = first_order(value(rate + "FLTE"));
      filters.target = first_order(value(rate + "FLTT"));
      filters.derivative = product(filters.error, first_order(value(rate + "FLTD")));
      break;
    }
    case FirmwareKind::betaflight: {
      constexpr double kYawLowPass = 100;  // [Hz] of P of the yaw
      // Where a cut-off moves with the throttle, its lower end.
      const auto first = [&](const std::string& name) {
        const double least = value(name + "_dyn_min_hz");
        return first_order(least > 0 ? least : value(name + "_static_hz"));
      };
      filters.gyroscope = product(first("gyro_lpf1"), first_order(value("gyro_lpf2_static_hz")));
      filters.derivative = product(first("dterm_lpf1"), first_order(value("dterm_lpf2_static_hz")));
      if (yaw) filters.error = first_order(kYawLowPass);
      break;
    }
    case FirmwareKind::crazyflie:
      constexpr double kGyroscope = 80;  // [Hz]
      filters.gyroscope = butterworth(kGyroscope);
      break;
  }
  return filters;
}

double rate_of(const Firmware& firmware, const ParameterValues& value) {
  switch (firmware.kind) {
    case FirmwareKind::px4:
      return value("IMU_GYRO_RATEMAX");
    case FirmwareKind::ardupilot:
      return value("SCHED_LOOP_RATE");
    case FirmwareKind::betaflight:
      return 4000;  // of the usual boards
    case FirmwareKind::crazyflie:
      return 500;
  }
  return 0;
}

/// By how long the torque about z leads the rotors' speed [s]: that of the air, Q(w), and the
/// reaction to its change, J_r w', give (dQ/dw + J_r s) δw.
double yaw_lead(const Vehicle& vehicle) {
  double lead = 0;
  for (const Rotor& rotor : vehicle.rotors) {
    const double share = vehicle.mass * vehicle.gravity / std::ssize(vehicle.rotors);
    const double w = rotor_speed_for_thrust(rotor, share);
    lead +=
        rotor.inertia / (2 * rotor.torque_d2 * w + rotor.torque_d1) / std::ssize(vehicle.rotors);
  }
  return lead;
}

}  // namespace

double firmware_delay(const Firmware& firmware, const Vehicle& vehicle,
                      const std::vector<Parameter>& values) {
  // A sample to compute, half of one because the output is held.
  const ParameterValues value(firmware, values);
  return 1.5 / rate_of(firmware, value) + vehicle.motor.delay +
         (vehicle.sensors.gyroscope ? vehicle.sensors.gyroscope->delay : 0);
}

ContinuousTransferFunction firmware_turn_loop(const Firmware& firmware, const Vehicle& vehicle,
                                              const FirmwareLoop& loop,
                                              const std::vector<Parameter>& values, bool angle) {
  const ParameterValues value(firmware, values);
  Filters f = filters_of(firmware, loop.axis, value);
  // τ/scale = (P + I/s) E R + FF R' + D s Fd X, each times the rate, with
  //   a = (Oo s + Oi)/s^k T     the loop of the angle, T the target's filter
  //   R = (1 + Od) F + a,  R' = Od F + a
  //   X = F, or where D acts on the error F + a
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
  // All over s^(pi + k) E F Fd T.
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
  result.den = product(result.den, Eigen::Vector2d(J, 0));
  if (const double lag = internal::rotor_lag(vehicle); lag > 0)
    result.den = product(result.den, Eigen::Vector2d(lag, 1));
  result.delay = firmware_delay(firmware, vehicle, values);
  return result;
}

}  // namespace quadtune
