// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/state_feedback_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

Eigen::Index index_in(const std::vector<Signal>& states, const std::string& name) {
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i].name == name) return static_cast<Eigen::Index>(i);
  throw InvalidInput(
      "gains", fmt::format("no state '{}' in their convention, expected {}", name, names(states)));
}

GuardedIntegralSettings<double> guard_of(const std::string& state, double dt,
                                         const std::vector<IntegralGuard>& guards) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto found = std::find_if(guards.begin(), guards.end(),
                                  [&](const IntegralGuard& guard) { return guard.state == state; });
  GuardedIntegralSettings<double> settings{dt, kInfinity, kInfinity, kInfinity};
  if (found != guards.end())
    settings = {dt, found->error_limit, found->increment_limit, found->integral_limit};
  validate(settings, "integral of '" + state + "'");
  return settings;
}

/// @param W  from the inputs of the gains' convention to quadtune's own: a signed permutation
void remember(const CommandMemory& memory, const Eigen::MatrixXd& W, double dt,
              StateFeedbackSettings<double>& settings) {
  const int n = settings.inputs;
  settings.remembers = true;
  settings.lag_share.head(n) =
      W.cwiseAbs() * memory.lag.unaryExpr([dt](double lag) { return -std::expm1(-dt / lag); });
  settings.K_lag.topLeftCorner(n, n) = W * memory.K_lag * W.transpose();
  settings.past = memory.past;
  settings.K_past.setZero(kMaxRotors, static_cast<Eigen::Index>(memory.past) * n);
  for (int k = 0; k < memory.past; ++k)
    settings.K_past.block(0, k * n, n, n) =
        W * memory.K_past.middleCols(static_cast<Eigen::Index>(k) * n, n) * W.transpose();
}

}  // namespace

const std::vector<IntegralGuard>& uquad_integral_guards() {
  static const std::vector<IntegralGuard> guards = {
      {"x", 1, 1, 5},         {"y", 1, 1, 5},         {"z", 2, 2.5e-3, 2},
      {"psi", 0.26, 1e-3, 1}, {"phi", 0.26, 1e-3, 1}, {"theta", 0.78, 7e-3, 2}};
  return guards;
}

StateFeedbackSettings<double> state_feedback_settings(const Vehicle& vehicle, const Gains& gains,
                                                      double dt,
                                                      const std::vector<IntegralGuard>& guards) {
  validate(gains, "gains");
  const Convention& words = convention(gains.convention, "gains");
  const int rotors = static_cast<int>(vehicle.rotors.size());
  const int inputs = gains.input_kind == InputKind::wrench ? 4 : rotors;
  if (rotors < 1 || rotors > kMaxRotors)
    throw InvalidInput("gains", fmt::format("'{}' has {} rotors, expected 1 to {}", vehicle.name,
                                            rotors, kMaxRotors));
  if (gains.integrals.size() > static_cast<std::size_t>(kMostIntegrals))
    throw InvalidInput("gains", fmt::format("{} integrals, expected at most {}, one for each state",
                                            gains.integrals.size(), kMostIntegrals));
  if (gains.K.rows() != inputs)
    throw InvalidInput("gains", fmt::format("K has {} rows, expected {}, one for each input of "
                                            "'{}'",
                                            gains.K.rows(), inputs, vehicle.name));
  if (gains.dt > 0 && std::abs(gains.dt - dt) > 1e-9 * dt)
    throw InvalidInput("gains", fmt::format("their sample period is {} s, expected {} s, at which "
                                            "the law shall run",
                                            gains.dt, dt));
  StateFeedbackSettings<double> settings;
  settings.input_kind = gains.input_kind;
  settings.inputs = inputs;
  // u_ned = W u: a signed permutation, so its inverse is its transpose.
  const Eigen::MatrixXd W = input_from_ned(words, gains.input_kind, rotors).transpose();
  const double law = gains.sign_law == SignLaw::set_point_minus_state ? 1 : -1;
  const Eigen::MatrixXd K = law * W * gains.K;
  const Eigen::MatrixXd K_int = law * W * gains.K_int;
  for (std::size_t j = 0; j < gains.states.size(); ++j) {
    const Eigen::Index row = index_in(words.states, gains.states[j].name);
    settings.K.topLeftCorner(inputs, 12) +=
        K.col(static_cast<Eigen::Index>(j)) * words.from_ned.row(row);
    settings.x0 += words.from_ned.row(row).transpose() * gains.x0(static_cast<Eigen::Index>(j));
  }
  settings.integrals = static_cast<int>(gains.integrals.size());
  for (std::size_t j = 0; j < gains.integrals.size(); ++j) {
    const std::string& name = gains.integrals[j].name;
    const Eigen::Index row = index_in(words.states, name);
    Eigen::Index state = 0;
    words.from_ned.row(row).cwiseAbs().maxCoeff(&state);
    const double sign = words.from_ned(row, state);
    settings.integrated[j] = static_cast<int>(state);
    settings.K_int.col(static_cast<Eigen::Index>(j)).head(inputs) =
        sign * K_int.col(static_cast<Eigen::Index>(j));
    settings.guards[j] = guard_of(name, dt, guards);
  }
  settings.u0.head(inputs) = W * gains.u0;
  settings.axes = gains.axes;
  settings.position_error_limit = gains.limits.position_error;
  settings.conditional_integration = gains.limits.conditional_integration;
  if (gains.memory) remember(*gains.memory, W, dt, settings);
  return settings;
}

}  // namespace quadtune
