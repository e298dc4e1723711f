// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_gains.hpp"

#include <fmt/format.h>

#include <ostream>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {

constexpr internal::EnumName<PidType> kPidTypes[] = {
    {PidType::P, "P"}, {PidType::PI, "PI"}, {PidType::PD, "PD"}, {PidType::PID, "PID"}};

std::string to_string(PidType type) { return internal::name_in(kPidTypes, type); }

std::complex<double> PidGains::operator()(std::complex<double> s) const {
  std::complex<double> C = Kp;
  if (Ki != 0) C += Ki / s;
  if (Kd != 0) C += Kd * s / (Tf * s + 1.0);
  return C;
}

ContinuousTransferFunction loop_of(const ContinuousTransferFunction& plant, const PidGains& gains) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const Eigen::VectorXd s = Eigen::Vector2d(1, 0);
  const bool filtered = gains.Kd != 0 && gains.Tf > 0;
  const Eigen::VectorXd integral = gains.Ki != 0 ? s : one;
  const Eigen::VectorXd filter = filtered ? Eigen::VectorXd(Eigen::Vector2d(gains.Tf, 1)) : one;
  const Eigen::VectorXd both = polynomial_product(integral, filter);
  const Eigen::VectorXd lead = polynomial_product(s, integral);
  Eigen::VectorXd num = Eigen::VectorXd::Zero(3);
  num.tail(both.size()) += gains.Kp * both;
  if (gains.Ki != 0) num.tail(filter.size()) += gains.Ki * filter;
  if (gains.Kd != 0) num.tail(lead.size()) += gains.Kd * lead;
  return {without_leading_zeros(polynomial_product(num, plant.num)),
          polynomial_product(both, plant.den), plant.delay};
}

std::ostream& operator<<(std::ostream& out, const PidGains& gains) {
  return out << fmt::format("Kp {:.6g}, Ki {:.6g}, Kd {:.6g}, Tf {:.6g} s", gains.Kp, gains.Ki,
                            gains.Kd, gains.Tf);
}

PidStandard standard_form(const PidGains& gains) {
  if (gains.Kp == 0 && (gains.Ki != 0 || gains.Kd != 0))
    throw InvalidInput("standard_form",
                       fmt::format("Kp is 0 with Ki {} and Kd {}, expected a Kp other "
                                   "than 0 because the standard form multiplies by it",
                                   gains.Ki, gains.Kd));
  PidStandard standard;
  standard.K = gains.Kp;
  standard.Tf = gains.Tf;
  if (gains.Ki != 0) standard.Ti = gains.Kp / gains.Ki;
  if (gains.Kd != 0) standard.Td = gains.Kd / gains.Kp;
  return standard;
}

PidGains parallel_form(const PidStandard& standard) {
  if (standard.Ti == 0 || standard.Ti != standard.Ti)
    throw InvalidInput("parallel_form", fmt::format("Ti is {} s, expected a number other than 0 "
                                                    "because Ki = K/Ti",
                                                    standard.Ti));
  return {standard.K, standard.K / standard.Ti, standard.K * standard.Td, standard.Tf};
}

PidSettings<double> pid_settings(const PidGains& gains, double dt, PidMethod method) {
  PidSettings<double> settings;
  settings.dt = dt;
  settings.Kp = gains.Kp;
  settings.Ki = gains.Ki;
  settings.Kd = gains.Kd;
  settings.Tf = gains.Tf;
  settings.method = method;
  settings.derivative = gains.Tf > 0 ? PidDerivative::filtered : PidDerivative::difference;
  validate(settings, "pid_settings");
  return settings;
}

}  // namespace quadtune
