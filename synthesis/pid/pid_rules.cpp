// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

void require_positive(double value, const char* what, const char* unit, const char* where) {
  if (!(value > 0) || !std::isfinite(value))
    throw InvalidInput(where,
                       fmt::format("{} is {}{}, expected a positive number", what, value, unit));
}

void require_gain(double gain, const char* where) {
  if (gain == 0 || !std::isfinite(gain))
    throw InvalidInput(where, fmt::format("gain is {}, expected a finite number other than 0 "
                                          "because the rule divides by it",
                                          gain));
}

void require_delay(double delay, const char* where) {
  if (!(delay >= 0) || !std::isfinite(delay))
    throw InvalidInput(where, fmt::format("delay is {} s, expected 0 or more", delay));
}

/// Checks the model for the rules that divide by the delay.
void require_lag_and_delay(const FopdtModel& model, const char* where) {
  require_gain(model.gain, where);
  require_positive(model.time_constant, "time constant", " s", where);
  if (!(model.delay > 0) || !std::isfinite(model.delay))
    throw InvalidInput(where, fmt::format("delay is {} s, expected more than 0 because the rule "
                                          "divides by it",
                                          model.delay));
}

[[noreturn]] void refuse(PidType type, const char* known, const char* where) {
  throw InvalidInput(where,
                     fmt::format("type is {}, expected {} because the rule has no other types",
                                 to_string(type), known));
}

PidGains with_filter(PidStandard standard, double N, const char* where) {
  if (!(N > 0))
    throw InvalidInput(where, fmt::format("N is {}, expected more than 0 because Tf = Td/N", N));
  standard.Tf = standard.Td / N;
  return parallel_form(standard);
}

constexpr double kNoIntegral = std::numeric_limits<double>::infinity();

}  // namespace

PidGains ziegler_nichols_step(PidType type, const FopdtModel& model, double N) {
  const char* where = "ziegler_nichols_step";
  require_lag_and_delay(model, where);
  const double L = model.delay;
  const double K = model.time_constant / (model.gain * L);
  switch (type) {
    case PidType::P:
      return with_filter({K, kNoIntegral, 0}, N, where);
    case PidType::PI:
      return with_filter({0.9 * K, L / 0.3, 0}, N, where);
    case PidType::PID:
      return with_filter({1.2 * K, 2 * L, L / 2}, N, where);
    case PidType::PD:
      break;
  }
  refuse(type, "P, PI or PID", where);
}

PidGains ziegler_nichols_ultimate(PidType type, double ultimate_gain, double ultimate_period,
                                  double N) {
  const char* where = "ziegler_nichols_ultimate";
  if (ultimate_gain == 0 || !std::isfinite(ultimate_gain))
    throw InvalidInput(where, fmt::format("ultimate gain is {}, expected a finite number other "
                                          "than 0",
                                          ultimate_gain));
  require_positive(ultimate_period, "ultimate period", " s", where);
  const double Tu = ultimate_period;
  switch (type) {
    case PidType::P:
      return with_filter({0.5 * ultimate_gain, kNoIntegral, 0}, N, where);
    case PidType::PI:
      return with_filter({0.45 * ultimate_gain, Tu / 1.2, 0}, N, where);
    case PidType::PID:
      return with_filter({0.6 * ultimate_gain, Tu / 2, Tu / 8}, N, where);
    case PidType::PD:
      break;
  }
  refuse(type, "P, PI or PID", where);
}

PidGains cohen_coon(PidType type, const FopdtModel& model, double N) {
  const char* where = "cohen_coon";
  require_lag_and_delay(model, where);
  const double L = model.delay;
  const double r = L / model.time_constant;
  const double K = 1 / (model.gain * r);
  switch (type) {
    case PidType::P:
      return with_filter({K * (1 + r / 3), kNoIntegral, 0}, N, where);
    case PidType::PI:
      return with_filter({K * (0.9 + r / 12), L * (30 + 3 * r) / (9 + 20 * r), 0}, N, where);
    case PidType::PD:
      if (!(r < 3))
        throw InvalidInput(where, fmt::format("delay is {:.4g} time constants, expected less than "
                                              "3 because the rule's Td turns negative there",
                                              r));
      return with_filter({K * (1.25 + r / 6), kNoIntegral, L * (6 - 2 * r) / (22 + 3 * r)}, N,
                         where);
    case PidType::PID:
      return with_filter(
          {K * (4.0 / 3 + r / 4), L * (32 + 6 * r) / (13 + 8 * r), 4 * L / (11 + 2 * r)}, N, where);
  }
  refuse(type, "P, PI, PD or PID", where);
}

PidGains amigo(PidType type, const FopdtModel& model, double N) {
  const char* where = "amigo";
  require_lag_and_delay(model, where);
  const double L = model.delay;
  const double T = model.time_constant;
  if (type == PidType::PI) {
    const double K = 0.15 + (0.35 - L * T / ((L + T) * (L + T))) * T / L;
    const double Ti = 0.35 * L + 13 * L * T * T / (T * T + 12 * L * T + 7 * L * L);
    return with_filter({K / model.gain, Ti, 0}, N, where);
  }
  if (type == PidType::PID) {
    const double Ti = L * (0.4 * L + 0.8 * T) / (L + 0.1 * T);
    const double Td = 0.5 * L * T / (0.3 * L + T);
    return with_filter({(0.2 + 0.45 * T / L) / model.gain, Ti, Td}, N, where);
  }
  refuse(type, "PI or PID", where);
}

PidGains simc(const FopdtModel& model, double tau_c) {
  return simc(SopdtModel{model.gain, model.time_constant, 0, model.delay}, tau_c);
}

PidGains simc(const SopdtModel& model, double tau_c, double N) {
  const char* where = "simc";
  require_gain(model.gain, where);
  require_positive(model.time_constant, "time constant", " s", where);
  require_delay(model.delay, where);
  if (!(model.second >= 0) || !std::isfinite(model.second))
    throw InvalidInput(
        where, fmt::format("second time constant is {} s, expected 0 or more", model.second));
  require_positive(tau_c + model.delay, "tau_c + delay", " s", where);
  const double K = model.time_constant / (model.gain * (tau_c + model.delay));
  const double Ti = std::min(model.time_constant, 4 * (tau_c + model.delay));
  const double f = 1 + model.second / Ti;
  return with_filter({K * f, Ti * f, model.second / f}, N, where);
}

PidGains lambda_tuning(PidType type, const FopdtModel& model, double lambda, double N) {
  const char* where = "lambda_tuning";
  require_gain(model.gain, where);
  require_positive(model.time_constant, "time constant", " s", where);
  require_delay(model.delay, where);
  require_positive(lambda, "lambda", " s", where);
  const double L = model.delay;
  const double T = model.time_constant;
  if (type == PidType::PI) return with_filter({T / (model.gain * (lambda + L)), T, 0}, N, where);
  if (type == PidType::PID)
    return with_filter(
        {(T + L / 2) / (model.gain * (lambda + L / 2)), T + L / 2, T * L / (2 * T + L)}, N, where);
  refuse(type, "PI or PID", where);
}

PidGains pi_by_poles(double gain, double time_constant, double w0, double zeta) {
  const char* where = "pi_by_poles";
  require_gain(gain, where);
  require_positive(time_constant, "time constant", " s", where);
  require_positive(w0, "w0", " rad/s", where);
  require_positive(zeta, "zeta", "", where);
  // T s² + (1 + gain Kp) s + gain Ki = T (s² + 2 zeta w0 s + w0²)
  return {(2 * zeta * w0 * time_constant - 1) / gain, w0 * w0 * time_constant / gain, 0, 0};
}

}  // namespace quadtune
