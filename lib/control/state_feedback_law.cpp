// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/state_feedback_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune {
namespace {

Eigen::Index index_in(const std::vector<Signal>& states, const std::string& name) {
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i].name == name) return static_cast<Eigen::Index>(i);
  throw InvalidInput(
      "gains", fmt::format("no state '{}' in the convention, expected {}", name, names(states)));
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

/// @param W  maps the inputs of the gains' convention to those of ned_convention(): a signed
///           permutation
void set_memory(const CommandMemory& memory, const Eigen::MatrixXd& W, double dt,
                StateFeedbackSettings<double>& settings) {
  const int n = settings.inputs;
  settings.remembers = true;
  settings.lag_share.head(n) =
      W.cwiseAbs() * memory.lag.unaryExpr([dt](double lag) { return -std::expm1(-dt / lag); });
  settings.K_lag.topLeftCorner(n, n) = W * memory.K_lag * W.transpose();
  settings.past = memory.past;
  settings.K_past.setZero(kMaxRotors, static_cast<Eigen::Index>(memory.past) * n);
  for (Eigen::Index k = 0; k < memory.past; ++k)
    settings.K_past.block(0, k * n, n, n) = W * memory.K_past.middleCols(k * n, n) * W.transpose();
}

}  // namespace

const std::vector<IntegralGuard>& uquad_integral_guards() {
  static const std::vector<IntegralGuard> guards = {
      {"x", 1, 1, 5},         {"y", 1, 1, 5},         {"z", 2, 2.5e-3, 2},
      {"psi", 0.26, 1e-3, 1}, {"phi", 0.26, 1e-3, 1}, {"theta", 0.78, 7e-3, 2}};
  return guards;
}

void FeedbackTransformation::set_gain(const Eigen::MatrixXd& K, const Eigen::MatrixXd& K_int,
                                      StateFeedbackSettings<double>& settings) const {
  const Eigen::Index nu = inputs.rows();
  settings.K.topLeftCorner(nu, 12) = law * inputs * K * states;
  settings.K_int.topLeftCorner(nu, integrals.size()) =
      law * inputs * K_int * integrals.asDiagonal();
}

void FeedbackTransformation::set_trim(const Eigen::VectorXd& x0, const Eigen::VectorXd& u0,
                                      StateFeedbackSettings<double>& settings) const {
  settings.x0 = states.transpose() * x0;
  settings.u0.head(inputs.rows()) = inputs * u0;
}

FeedbackTransformation feedback_words(const Vehicle& vehicle, const Gains& gains) {
  validate(gains, "gains");
  const Convention& words = convention(gains.convention, "gains");
  const int rotors = static_cast<int>(vehicle.rotors.size());
  const int inputs = gains.input_kind == InputKind::wrench ? 4 : rotors;
  if (rotors < 1 || rotors > kMaxRotors)
    throw InvalidInput("gains", fmt::format("'{}' has {} rotors, expected 1 to {}", vehicle.name,
                                            rotors, kMaxRotors));
  if (gains.integrals.size() > static_cast<std::size_t>(kMaxIntegrals))
    throw InvalidInput("gains", fmt::format("{} integrals, expected at most {}, one for each state",
                                            gains.integrals.size(), kMaxIntegrals));
  if (gains.K.rows() != inputs)
    throw InvalidInput("gains",
                       fmt::format("K has {}, expected {}, one for each input of "
                                   "'{}'",
                                   internal::counted(gains.K.rows(), "row"), inputs, vehicle.name));
  FeedbackTransformation result;
  // The inverse of a signed permutation is its transpose.
  result.inputs = input_from_ned(words, gains.input_kind, rotors).transpose();
  result.law = gains.sign_law == SignLaw::set_point_minus_state ? 1 : -1;
  result.states.resize(std::ssize(gains.states), 12);
  for (std::size_t j = 0; j < gains.states.size(); ++j)
    result.states.row(static_cast<Eigen::Index>(j)) =
        words.from_ned.row(index_in(words.states, gains.states[j].name));
  result.integrals.resize(std::ssize(gains.integrals));
  for (std::size_t j = 0; j < gains.integrals.size(); ++j) {
    const Eigen::Index row = index_in(words.states, gains.integrals[j].name);
    result.integrals(static_cast<Eigen::Index>(j)) = words.from_ned.row(row).sum();
  }
  return result;
}

StateFeedbackSettings<double> state_feedback_settings(const Vehicle& vehicle, const Gains& gains,
                                                      double dt,
                                                      const std::vector<IntegralGuard>& guards) {
  const FeedbackTransformation words = feedback_words(vehicle, gains);
  if (gains.dt > 0 && std::abs(gains.dt - dt) > 1e-9 * dt)
    throw InvalidInput("gains", fmt::format("the sample period is {} s, expected {} s, the control "
                                            "period of the law",
                                            gains.dt, dt));
  StateFeedbackSettings<double> settings;
  settings.input_kind = gains.input_kind;
  settings.inputs = static_cast<int>(gains.K.rows());
  settings.integrals = static_cast<int>(gains.integrals.size());
  words.set_gain(gains.K, gains.K_int, settings);
  words.set_trim(gains.x0, gains.u0, settings);
  const Convention& of = convention(gains.convention, "gains");
  for (std::size_t j = 0; j < gains.integrals.size(); ++j) {
    const std::string& name = gains.integrals[j].name;
    Eigen::Index state = 0;
    of.from_ned.row(index_in(of.states, name)).cwiseAbs().maxCoeff(&state);
    settings.integrated[j] = static_cast<int>(state);
    settings.guards[j] = guard_of(name, dt, guards);
  }
  settings.axes = gains.axes;
  settings.position_error_limit = gains.limits.position_error;
  settings.conditional_integration = gains.limits.conditional_integration;
  if (gains.memory) set_memory(*gains.memory, words.inputs, dt, settings);
  return settings;
}

}  // namespace quadtune
