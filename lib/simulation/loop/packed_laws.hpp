// SPDX-License-Identifier: Apache-2.0
/// Combines the control laws and allocations of N flights into one law and one allocation over
/// Pack<N>: lane l of each number belongs to flight l. The flights must have the same structure,
/// see same_structure().
#pragma once

#include <array>
#include <utility>

#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/control/limited_allocation.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/pack.hpp"

namespace quadtune::internal {

/// One kind of settings, computed for each of N flights.
template <int N, class Settings>
struct EachLane {
  std::array<Settings, N> from;

  template <class Function>
  EachLane(const std::array<const FlightSetup*, N>& setups, const Function& settings) {
    for (std::size_t l = 0; l < N; ++l) from[l] = settings(*setups[l]);
  }
  /// Sets each lane of a number.
  template <class Function>
  void operator()(Pack<N>& target, const Function& number) const {
    for (int l = 0; l < N; ++l) set_lane(target, l, number(from[static_cast<std::size_t>(l)]));
  }
};

/// The settings of N cascades of PID loops.
/// @param setups  each with a CascadeController
template <int N>
[[nodiscard]] CascadedPidSettings<Pack<N>> packed_cascade(
    const std::array<const FlightSetup*, N>& setups) {
  using P = Pack<N>;
  const EachLane<N, CascadedPidSettings<double>> of(setups, [](const FlightSetup& s) {
    const auto& c = std::get<CascadeController>(s.controller);
    return cascaded_pid_settings(s.vehicle, c.gains, c.method, c.attitude_limit, c.integrator_limit,
                                 c.back_calculation);
  });
  CascadedPidSettings<P> law;
  for (std::size_t i = 0; i < kCascadeAxes; ++i) {
    const PidSettings<double>& first = of.from[0].loops[i];
    PidSettings<P>& loop = law.loops[i];
    loop.method = first.method;
    loop.derivative = first.derivative;
    using Number = double PidSettings<double>::*;
    using Packed = P PidSettings<P>::*;
    const std::pair<Packed, Number> numbers[] = {
        {&PidSettings<P>::dt, &PidSettings<double>::dt},
        {&PidSettings<P>::Kp, &PidSettings<double>::Kp},
        {&PidSettings<P>::Ki, &PidSettings<double>::Ki},
        {&PidSettings<P>::Kd, &PidSettings<double>::Kd},
        {&PidSettings<P>::Tf, &PidSettings<double>::Tf},
        {&PidSettings<P>::rate_lead, &PidSettings<double>::rate_lead},
        {&PidSettings<P>::rate_share, &PidSettings<double>::rate_share},
        {&PidSettings<P>::b, &PidSettings<double>::b},
        {&PidSettings<P>::c, &PidSettings<double>::c},
        {&PidSettings<P>::output_min, &PidSettings<double>::output_min},
        {&PidSettings<P>::output_max, &PidSettings<double>::output_max},
        {&PidSettings<P>::integral_min, &PidSettings<double>::integral_min},
        {&PidSettings<P>::integral_max, &PidSettings<double>::integral_max},
        {&PidSettings<P>::back_calculation, &PidSettings<double>::back_calculation}};
    for (const auto& entry : numbers)
      of(loop.*entry.first, [&](const auto& s) { return s.loops[i].*entry.second; });
  }
  of(law.attitude_limit, [](const auto& s) { return s.attitude_limit; });
  of(law.weight, [](const auto& s) { return s.weight; });
  of(law.take_off_thrust, [](const auto& s) { return s.take_off_thrust; });
  of(law.max_thrust, [](const auto& s) { return s.max_thrust; });
  const auto& controller = std::get<CascadeController>(setups[0]->controller);
  law.velocity_feed_forward = controller.velocity_feed_forward;
  law.conditional_integration = controller.conditional_integration;
  return law;
}

/// The settings of N state feedback laws.
/// @param setups  each with a StateFeedbackController
template <int N>
[[nodiscard]] StateFeedbackSettings<Pack<N>> packed_feedback(
    const std::array<const FlightSetup*, N>& setups) {
  const EachLane<N, StateFeedbackSettings<double>> of(setups, [](const FlightSetup& s) {
    const auto& c = std::get<StateFeedbackController>(s.controller);
    return state_feedback_settings(s.vehicle, c.gains, c.dt, c.guards);
  });
  StateFeedbackSettings<Pack<N>> law;
  law.input_kind = of.from[0].input_kind;
  law.inputs = of.from[0].inputs;
  law.integrals = of.from[0].integrals;
  law.integrated = of.from[0].integrated;
  for (int i = 0; i < law.inputs; ++i) {
    of(law.u0(i), [&](const auto& s) { return s.u0(i); });
    for (int j = 0; j < 12; ++j) of(law.K(i, j), [&](const auto& s) { return s.K(i, j); });
    for (int j = 0; j < law.integrals; ++j)
      of(law.K_int(i, j), [&](const auto& s) { return s.K_int(i, j); });
  }
  for (int j = 0; j < 12; ++j) of(law.x0(j), [&](const auto& s) { return s.x0(j); });
  law.axes = of.from[0].axes;
  law.conditional_integration = of.from[0].conditional_integration;
  of(law.position_error_limit, [](const auto& s) { return s.position_error_limit; });
  law.remembers = of.from[0].remembers;
  law.past = of.from[0].past;
  law.K_past.resize(kMaxRotors, of.from[0].K_past.cols());
  for (int i = 0; i < law.inputs; ++i) {
    of(law.lag_share(i), [&](const auto& s) { return s.lag_share(i); });
    for (int j = 0; j < law.inputs; ++j)
      of(law.K_lag(i, j), [&](const auto& s) { return s.K_lag(i, j); });
    for (Eigen::Index j = 0; j < law.K_past.cols(); ++j)
      of(law.K_past(i, j), [&](const auto& s) { return s.K_past(i, j); });
  }
  for (std::size_t j = 0; j < static_cast<std::size_t>(law.integrals); ++j) {
    of(law.guards[j].dt, [&](const auto& s) { return s.guards[j].dt; });
    of(law.guards[j].error_limit, [&](const auto& s) { return s.guards[j].error_limit; });
    of(law.guards[j].increment_limit, [&](const auto& s) { return s.guards[j].increment_limit; });
    of(law.guards[j].integral_limit, [&](const auto& s) { return s.guards[j].integral_limit; });
  }
  return law;
}

/// The allocations of thrust among the rotors, of the vehicles that the laws assume.
template <int N>
[[nodiscard]] Allocation<Pack<N>> packed_allocation(
    const std::array<const FlightSetup*, N>& setups) {
  const EachLane<N, Allocation<double>> of(
      setups, [](const FlightSetup& s) { return allocation(s.vehicle); });
  Allocation<Pack<N>> result;
  result.rotors = of.from[0].rotors;
  result.thrust0.setZero(result.rotors);
  for (int i = 0; i < result.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    of(result.thrust0(i), [&](const auto& a) { return a.thrust0(i); });
    of(result.a2[k], [&](const auto& a) { return a.a2[k]; });
    of(result.a1[k], [&](const auto& a) { return a.a1[k]; });
    for (int j = 0; j < 4; ++j) {
      of(result.P(i, j), [&](const auto& a) { return a.P(i, j); });
      of(result.M(j, i), [&](const auto& a) { return a.M(j, i); });
    }
  }
  for (int j = 0; j < 4; ++j) of(result.wrench0(j), [&](const auto& a) { return a.wrench0(j); });
  return result;
}

/// The limits of each rotor's thrust.
/// @param rotors  number of rotors of each vehicle
template <int N>
[[nodiscard]] ThrustLimits<Pack<N>> packed_limits(const std::array<const FlightSetup*, N>& setups,
                                                  int rotors) {
  const EachLane<N, ThrustLimits<double>> of(
      setups, [](const FlightSetup& s) { return thrust_limits(s.vehicle); });
  ThrustLimits<Pack<N>> result;
  for (std::size_t k = 0; k < static_cast<std::size_t>(rotors); ++k) {
    of(result.min[k], [&](const auto& l) { return l.min[k]; });
    of(result.max[k], [&](const auto& l) { return l.max[k]; });
  }
  of(result.floor, [](const auto& l) { return l.floor; });
  return result;
}

}  // namespace quadtune::internal
