// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/standard_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kIntegralTime = 3;  ///< [s] an integral over this time at the limit costs 1

AxisWeights axis_weights(const CascadeVehicle& hover, const Vehicle& vehicle, FlownAxis axis) {
  const std::vector<Index>& states = states_of(axis);
  const Index input = wrench_of(axis);
  const LqrWeights all = standard_weights(hover);
  AxisWeights weights;
  weights.q = all.Q.diagonal()(states);
  weights.q_integral = weights.q(0) / (kIntegralTime * kIntegralTime);
  weights.r = all.R(input, input);
  // A step of 0.5 m or rad, and an impulse that leaves 0.5 m or 1 rad per second.
  weights.step = 0.5;
  weights.impulse = input == 0 ? 0.5 * vehicle.mass : vehicle.inertia(input - 1, input - 1);
  return weights;
}

}  // namespace

StandardAxes standard_axes(const Vehicle& vehicle) {
  const CascadeVehicle hover = cascade_vehicle(vehicle, place_of(vehicle));
  StandardAxes axes;
  for (std::size_t i = 0; i < axes.size(); ++i)
    axes[i] = axis_weights(hover, vehicle, kFlownAxes[i]);
  return axes;
}

std::vector<std::string> standard_integrals() {
  std::vector<std::string> names;
  names.reserve(kFlownAxes.size());
  for (const FlownAxis axis : kFlownAxes)
    names.push_back(
        ned_convention().states[static_cast<std::size_t>(states_of(axis).front())].name);
  return names;
}

ActuatorLqiWeights lqi_weights(const StandardAxes& axes,
                               const std::vector<std::string>& integrals) {
  ActuatorLqiWeights weights;
  weights.Q = MatrixXd::Zero(12, 12);
  weights.R = MatrixXd::Zero(4, 4);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::vector<Index>& states = states_of(kFlownAxes[i]);
    for (std::size_t j = 0; j < states.size(); ++j)
      weights.Q(states[j], states[j]) = axes[i].q(static_cast<Index>(j));
    const Index input = wrench_of(kFlownAxes[i]);
    weights.R(input, input) = axes[i].r;
  }
  const auto count = std::ssize(integrals);
  weights.Q_integral = MatrixXd::Zero(count, count);
  const std::vector<Signal>& states = ned_convention().states;
  for (Index i = 0; i < count; ++i) {
    const std::string& name = integrals[static_cast<std::size_t>(i)];
    const auto found = std::find_if(states.begin(), states.end(),
                                    [&](const Signal& state) { return state.name == name; });
    if (found == states.end())
      throw InvalidInput("LQI weights",
                         fmt::format("no state '{}' to integrate; expected one or more of: {}",
                                     name, names(states)));
    const Index state = found - states.begin();
    weights.Q_integral(i, i) = weights.Q(state, state) / (kIntegralTime * kIntegralTime);
  }
  return weights;
}

}  // namespace quadtune
