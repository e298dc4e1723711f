// SPDX-License-Identifier: Apache-2.0
#include "quadtune/gains.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

void validate(const Gains& gains, const std::string& where) {
  const auto nx = static_cast<Eigen::Index>(gains.states.size());
  const auto nu = static_cast<Eigen::Index>(gains.inputs.size());
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  require_shape(gains.K, nu, nx, where, "K",
                fmt::format("inputs: {}; states: {}", names(gains.inputs), names(gains.states)));
  if (ni > 0 || gains.K_int.size() > 0)
    require_shape(
        gains.K_int, nu, ni, where, "K_int",
        fmt::format("inputs: {}; integrals: {}", names(gains.inputs), names(gains.integrals)));
  require_finite(gains.K, where, "K");
  require_finite(gains.K_int, where, "K_int");
  require_shape(gains.x0, nx, 1, where, "x0", "one entry per state");
  require_shape(gains.u0, nu, 1, where, "u0", "one entry per input");
  require_finite(gains.x0, where, "x0");
  require_finite(gains.u0, where, "u0");
  if (!(gains.dt >= 0) || !std::isfinite(gains.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected 0 (continuous) or more", gains.dt));
}

namespace {

int index_of(const std::vector<Signal>& signals, const std::string& name) {
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (signals[i].name == name) return static_cast<int>(i);
  throw InvalidInput("open_loop",
                     fmt::format("no state '{}' in the plant, expected {}", name, names(signals)));
}

}  // namespace

std::vector<Signal> integral_signals(const std::vector<Signal>& states,
                                     const std::vector<std::string>& integrated) {
  std::vector<Signal> signals;
  signals.reserve(integrated.size());
  for (const std::string& name : integrated)
    for (const Signal& state : states)
      if (state.name == name) signals.push_back({name, state.unit + " s"});
  return signals;
}

DiscreteLti open_loop(const DiscreteLti& plant, const Gains& gains) {
  validate(plant, "open_loop");
  validate(gains, "open_loop");
  const auto nx = static_cast<Eigen::Index>(gains.states.size());
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  require_shape(plant.A, nx, nx, "open_loop", "plant.A", "states: " + names(gains.states));
  if (names(plant.inputs) != names(gains.inputs))
    throw InvalidInput("open_loop", fmt::format("the plant's inputs are {}, expected {}",
                                                names(plant.inputs), names(gains.inputs)));
  std::vector<int> order;
  for (const Signal& state : gains.states) order.push_back(index_of(plant.states, state.name));
  const double sign = gains.sign_law == SignLaw::set_point_minus_state ? -1 : 1;

  // With s = -1 for set point minus state: [x; i]⁺ = [A, 0; s dt E, I] [x; i] + [B; 0] u, and
  // u = s K x + K_int i comes back.
  DiscreteLti loop;
  loop.dt = plant.dt;
  loop.A = Eigen::MatrixXd::Identity(nx + ni, nx + ni);
  loop.A.topLeftCorner(nx, nx) = plant.A(order, order);
  loop.B = Eigen::MatrixXd::Zero(nx + ni, plant.B.cols());
  loop.B.topRows(nx) = plant.B(order, Eigen::all);
  loop.C.resize(plant.B.cols(), nx + ni);
  loop.C << -sign * gains.K, -gains.K_int;
  loop.states = gains.states;
  for (Eigen::Index i = 0; i < ni; ++i) {
    const Signal& integral = gains.integrals[static_cast<std::size_t>(i)];
    loop.A(nx + i, index_of(gains.states, integral.name)) = sign * plant.dt;
    loop.states.push_back({"int_" + integral.name, integral.unit});
  }
  loop.inputs = gains.inputs;
  loop.outputs = gains.inputs;
  return loop;
}

}  // namespace quadtune
