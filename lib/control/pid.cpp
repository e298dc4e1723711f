// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/pid.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

void require_finite(double value, const char* name, const std::string& where) {
  if (!std::isfinite(value))
    throw InvalidInput(where, fmt::format("{} is {}, expected a finite number", name, value));
}

template <class Scalar>
void require_ordered(Scalar low, Scalar high, const char* name, const std::string& where) {
  if (!(low <= high))
    throw InvalidInput(where, fmt::format("{0}_min is {1} and {0}_max {2}, expected the minimum "
                                          "not to exceed the maximum",
                                          name, low, high));
}

/// Checks that the pole of the sampled filter is within the unit circle.
template <class Scalar>
void require_stable_filter(const PidSettings<Scalar>& settings, const std::string& where) {
  if (settings.derivative != PidDerivative::filtered) return;
  const Scalar Tf = settings.Tf;
  switch (settings.method) {
    case PidMethod::forward_euler:
      if (!(2 * Tf > settings.dt))
        throw InvalidInput(where, fmt::format("Tf is {} s, expected more than dt/2 = {} s because "
                                              "otherwise forward Euler makes the filter unstable",
                                              Tf, settings.dt / 2));
      return;
    case PidMethod::backward_euler:
      if (!(Tf >= 0))
        throw InvalidInput(where, fmt::format("Tf is {} s, expected 0 or more because it is a "
                                              "time constant",
                                              Tf));
      return;
    case PidMethod::tustin:
      if (!(Tf > 0))
        throw InvalidInput(where, fmt::format("Tf is {} s, expected more than 0 because with "
                                              "Tustin's rule an unfiltered derivative rings "
                                              "forever",
                                              Tf));
      return;
  }
}

template <class Scalar>
void validate_pid(const PidSettings<Scalar>& settings, const std::string& where) {
  if (!(settings.dt > 0) || !std::isfinite(settings.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected a positive number", settings.dt));
  require_finite(settings.Kp, "Kp", where);
  require_finite(settings.Ki, "Ki", where);
  require_finite(settings.Kd, "Kd", where);
  require_finite(settings.Tf, "Tf", where);
  if (!(settings.rate_lead >= 0) || !std::isfinite(settings.rate_lead) ||
      !(settings.rate_share >= 0 && settings.rate_share <= 1))
    throw InvalidInput(where, fmt::format("rate_lead is {} and rate_share {}, expected a finite "
                                          "number of 0 or more and a share of 0 to 1",
                                          settings.rate_lead, settings.rate_share));
  require_finite(settings.b, "b", where);
  require_finite(settings.c, "c", where);
  require_ordered(settings.output_min, settings.output_max, "output", where);
  require_ordered(settings.integral_min, settings.integral_max, "integral", where);
  if (!(settings.back_calculation >= 0 && settings.back_calculation * settings.dt <= 1))
    throw InvalidInput(where,
                       fmt::format("back_calculation is {} 1/s, expected 0 to 1/dt = {} because "
                                   "a larger gain overcorrects the integral within one sample",
                                   settings.back_calculation, 1 / settings.dt));
  require_stable_filter(settings, where);
}

/// proportional + integral · Ki dt (now z + before)/(z - 1)
///              + difference · gain (z - 1)/(z - pole), over a common denominator
DiscreteTransferFunction combine(const PidSettings<double>& settings, double proportional,
                                 double integral, double difference) {
  const PidQuadrature<double> weight = pid_quadrature<double>(settings.method);
  const PidDifference<double> d = pid_difference(settings);
  const double i = settings.Ki * settings.dt * integral;
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  // A part that is disabled must not add a pole, which would cancel with a zero.
  const Eigen::VectorXd z_1 = i != 0 ? Eigen::VectorXd(Eigen::Vector2d(1, -1)) : one;
  const Eigen::VectorXd z_pole =
      difference * d.gain != 0 ? Eigen::VectorXd(Eigen::Vector2d(1, -d.pole)) : one;
  DiscreteTransferFunction result;
  result.dt = settings.dt;
  result.den = polynomial_product(z_1, z_pole);
  result.num = proportional * result.den;
  if (z_1.size() > 1)
    result.num += i * polynomial_product(Eigen::Vector2d(weight.now, weight.before), z_pole);
  if (z_pole.size() > 1)
    result.num += difference * d.gain * polynomial_product(Eigen::Vector2d(1, -1), z_1);
  return result;
}

}  // namespace

void validate(const PidSettings<double>& settings, const std::string& where) {
  validate_pid(settings, where);
}

void validate(const PidSettings<float>& settings, const std::string& where) {
  validate_pid(settings, where);
}

PidSettings<double> pid_settings(const PidLoop& loop, double dt) {
  PidSettings<double> settings;
  settings.dt = dt;
  settings.Kp = loop.Kp;
  settings.Ki = loop.Ki;
  settings.Kd = -loop.Kd;
  const std::string where = "loop " + loop.name;
  if (!(loop.rate_lead >= 0) || !(loop.rate_filter >= 0) || !std::isfinite(loop.rate_filter))
    throw InvalidInput(where, fmt::format("rate_lead is {} s and rate_filter {} s, expected finite "
                                          "times of 0 or more",
                                          loop.rate_lead, loop.rate_filter));
  if (loop.rate_lead > 0) {
    settings.rate_lead = loop.rate_lead / (loop.rate_filter + dt);
    settings.rate_share = dt / (loop.rate_filter + dt);
  }
  validate(settings, where);
  return settings;
}

DiscreteTransferFunction pid_transfer_function(const PidSettings<double>& settings,
                                               PidChannel channel) {
  validate(settings, "pid_transfer_function");
  switch (channel) {
    case PidChannel::error:
      return combine(settings, settings.Kp, 1, 1);
    case PidChannel::set_point:
      return combine(settings, settings.Kp * settings.b, 1, settings.c);
    case PidChannel::measurement:
      return combine(settings, -settings.Kp, -1, -1);
    case PidChannel::rate:
      break;
  }
  const bool measured = settings.derivative == PidDerivative::measured_rate;
  DiscreteTransferFunction result = combine(settings, measured ? -settings.Kd : 0, 0, 0);
  if (!measured || settings.rate_lead == 0) return result;
  // -Kd (1 + lead (z - 1)/(z - 1 + share))
  result.den = Eigen::Vector2d(1, settings.rate_share - 1);
  result.num = -settings.Kd * (result.den + settings.rate_lead * Eigen::Vector2d(1, -1));
  return result;
}

}  // namespace quadtune
