// SPDX-License-Identifier: Apache-2.0
#include "quadtune/gains.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
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
  if (!(gains.limits.position_error > 0))
    throw InvalidInput(where, fmt::format("the limit of the position error is {} m, expected more "
                                          "than 0",
                                          gains.limits.position_error));
  if (!gains.memory) return;
  const CommandMemory& memory = *gains.memory;
  if (!(gains.dt > 0))
    throw InvalidInput(where,
                       "dt is 0 s, expected a sample period because the law feeds back its "
                       "own past commands");
  require_shape(memory.lag, nu, 1, where, "lag", "one entry per input");
  for (const double lag : memory.lag)
    if (!(lag > 0) || !(lag <= kMaxActuatorLag))
      throw InvalidInput(where, fmt::format("lag is {} s, expected more than 0, at most {} s", lag,
                                            kMaxActuatorLag));
  require_shape(memory.K_lag, nu, nu, where, "K_lag", "inputs: " + names(gains.inputs));
  require_finite(memory.K_lag, where, "K_lag");
  if (memory.past < 0 || memory.past > kMaxPastCommands)
    throw InvalidInput(where, fmt::format("past is {}, expected 0 to {} control periods",
                                          memory.past, kMaxPastCommands));
  require_shape(memory.K_past, nu, nu * memory.past, where, "K_past",
                fmt::format("past: {}; inputs: {}", memory.past, names(gains.inputs)));
  require_finite(memory.K_past, where, "K_past");
}

constexpr internal::EnumName<PositionAxes> kPositionAxes[] = {{PositionAxes::world, "world"},
                                                              {PositionAxes::heading, "heading"}};

std::string to_string(PositionAxes axes) { return internal::name_in(kPositionAxes, axes); }

PositionAxes position_axes(const std::string& name, const std::string& where) {
  if (const auto axes = internal::value_in(kPositionAxes, name)) return *axes;
  throw InvalidInput(
      where, fmt::format("axes is '{}', expected world or heading{}", internal::printable(name),
                         internal::did_you_mean(name, internal::names_in(kPositionAxes))));
}

namespace {

int index_of(const std::vector<Signal>& signals, const std::string& name) {
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (signals[i].name == name) return static_cast<int>(i);
  throw InvalidInput("open_loop",
                     fmt::format("no state '{}' in the plant, expected {}", name, names(signals)));
}

/// Adds the law's memory of its own commands, u = -C x: the actuators' states m, then the past
/// commands.
void remember(const CommandMemory& memory, DiscreteLti& loop) {
  const Eigen::Index n = loop.A.rows(), nu = loop.C.rows(), past = memory.past;
  const Eigen::Index all = n + nu * (1 + past);
  loop.A.conservativeResizeLike(Eigen::MatrixXd::Zero(all, all));
  loop.B.conservativeResizeLike(Eigen::MatrixXd::Zero(all, loop.B.cols()));
  loop.C.conservativeResizeLike(Eigen::MatrixXd::Zero(nu, all));
  loop.C.middleCols(n, nu) = memory.K_lag;
  loop.C.rightCols(nu * past) = memory.K_past;
  for (Eigen::Index i = 0; i < nu; ++i) {
    const double share = -std::expm1(-loop.dt / memory.lag(i));
    loop.A(n + i, n + i) = 1 - share;
    if (past > 0)
      loop.A(n + i, all - nu + i) += share;
    else
      loop.A.row(n + i) -= share * loop.C.row(i);
  }
  for (Eigen::Index j = 0; j < past; ++j) {
    const Eigen::Index at = n + nu * (1 + j);
    if (j == 0)
      loop.A.middleRows(at, nu) = -loop.C;
    else
      loop.A.block(at, at - nu, nu, nu).setIdentity();
  }
  for (const Signal& input : loop.inputs) loop.states.push_back({"lag_" + input.name, input.unit});
  for (Eigen::Index j = 0; j < past; ++j)
    for (const Signal& input : loop.inputs)
      loop.states.push_back({fmt::format("{}[k-{}]", input.name, j + 1), input.unit});
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
  // Files such as K*.txt state no period; their gains have dt = 0.
  constexpr double kSamePeriod = 1e-12;  // [s]
  if (gains.dt > 0 && std::abs(gains.dt - plant.dt) > kSamePeriod)
    throw InvalidInput("open_loop", fmt::format("the gains have a sample period of {} s, expected "
                                                "{} s, that of the plant",
                                                gains.dt, plant.dt));
  const auto nx = static_cast<Eigen::Index>(gains.states.size());
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  require_shape(plant.A, nx, nx, "open_loop", "plant.A", "states: " + names(gains.states));
  if (names(plant.inputs) != names(gains.inputs))
    throw InvalidInput("open_loop", fmt::format("the inputs of the gains are {}, expected {}",
                                                names(gains.inputs), names(plant.inputs)));
  std::vector<int> order;
  for (const Signal& state : gains.states) order.push_back(index_of(plant.states, state.name));
  const double sign = gains.sign_law == SignLaw::set_point_minus_state ? -1 : 1;

  // With s = -1 for set point minus state: [x; i]⁺ = [A, 0; s dt E, I] [x; i] + [B; 0] u; the
  // output of the loop is s K x + K_int i.
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
  if (gains.memory) remember(*gains.memory, loop);
  return loop;
}

}  // namespace quadtune
