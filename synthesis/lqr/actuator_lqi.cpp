// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/actuator_lqi.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flown/flown_body.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kWhere = "actuator LQI";

/// The lag of each input; empty if no rotor lags.
VectorXd lags(const Vehicle& vehicle, InputKind inputs) {
  const Index n = std::ssize(vehicle.rotors);
  VectorXd lag(n);
  for (Index i = 0; i < n; ++i) lag(i) = slower_lag(vehicle.rotors[static_cast<std::size_t>(i)]);
  if (lag.isZero(0)) return {};
  if (!(lag.minCoeff() > 0))
    throw InvalidInput(kWhere, fmt::format("'{}' has rotors with and without lag, expected a "
                                           "lag of all rotors or of none",
                                           vehicle.name));
  if (inputs == InputKind::wrench) return VectorXd::Constant(4, lag.mean());
  return lag;
}

/// Torque about the yaw axis per rate of change of each actuator's state, -Σ s_i J_i ∂w_i/∂u.
Eigen::RowVectorXd reaction(const Vehicle& vehicle, const VectorXd& speeds, InputKind inputs) {
  const MatrixXd E = internal::commanded_speeds(vehicle, speeds, inputs);
  Eigen::RowVectorXd torque = Eigen::RowVectorXd::Zero(E.cols());
  for (Index i = 0; i < E.rows(); ++i) {
    const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
    torque -= spin_sign(rotor.spin) * rotor.inertia * E.row(i);
  }
  return torque;
}

struct Layout {
  Index nx, nu, past, ni;
  [[nodiscard]] Index past_at() const { return nx; }
  [[nodiscard]] Index integrals_at() const { return nx + past * nu; }
  [[nodiscard]] Index size() const { return nx + past * nu + ni; }
};

std::vector<Index> integrated_states(const ActuatorLqiOptions& options) {
  std::vector<Index> at;
  const std::vector<Signal>& states = ned_convention().states;
  for (const std::string& name : options.integrals) {
    const auto found = std::find_if(states.begin(), states.end(),
                                    [&](const Signal& state) { return state.name == name; });
    if (found == states.end())
      throw InvalidInput(kWhere, fmt::format("no state '{}' to integrate, expected one of: {}",
                                             name, names(states)));
    if (std::find(at.begin(), at.end(), found - states.begin()) != at.end())
      throw InvalidInput(kWhere,
                         fmt::format("'{}' is listed twice, expected each state once", name));
    at.push_back(found - states.begin());
  }
  return at;
}

void require(const ActuatorLqiWeights& weights, const ActuatorLqiOptions& options, Index nu) {
  if (!(options.dt > 0) || !std::isfinite(options.dt))
    throw InvalidInput(kWhere, fmt::format("dt is {} s, expected a positive period", options.dt));
  if (options.past < 0 || options.past > kMaxPastCommands)
    throw InvalidInput(kWhere, fmt::format("past is {}, expected 0 to {} control periods",
                                           options.past, kMaxPastCommands));
  const Index ni = std::ssize(options.integrals);
  require_shape(weights.Q, 12, 12, kWhere, "Q", "one row and column per state");
  require_shape(weights.R, nu, nu, kWhere, "R", "one row and column per input");
  require_shape(weights.Q_integral, ni, ni, kWhere, "Q_integral",
                "one row and column per integral");
  require_symmetric(weights.Q, kWhere, "Q");
  require_symmetric(weights.R, kWhere, "R");
  if (ni > 0) require_symmetric(weights.Q_integral, kWhere, "Q_integral");
  if (weights.R_change.size() == 0) return;
  if (options.past < 1)
    throw InvalidInput(kWhere,
                       "R_change is given but past is 0, expected past >= 1 because the law "
                       "needs its last command");
  require_shape(weights.R_change, nu, nu, kWhere, "R_change", "one row and column per input");
  require_symmetric(weights.R_change, kWhere, "R_change");
}

/// The sampled problem with past commands and integrals.
SampledLqr augmented(const ActuatorModel& model, const ActuatorLqiWeights& weights,
                     const ActuatorLqiOptions& options, const Layout& at) {
  LqrWeights continuous;
  continuous.Q = MatrixXd::Zero(at.nx, at.nx);
  continuous.Q.topLeftCorner(12, 12) = weights.Q;
  continuous.R = weights.R;
  const SampledLqr body = sample(model.plant, continuous, options.dt);
  SampledLqr all;
  all.plant.dt = options.dt;
  all.plant.states = model.plant.states;
  all.plant.inputs = model.plant.inputs;
  all.plant.A = MatrixXd::Zero(at.size(), at.size());
  all.plant.B = MatrixXd::Zero(at.size(), at.nu);
  LqrWeights& w = all.weights;
  w.Q = MatrixXd::Zero(at.size(), at.size());
  w.N = MatrixXd::Zero(at.size(), at.nu);
  all.plant.A.topLeftCorner(at.nx, at.nx) = body.plant.A;
  w.Q.topLeftCorner(at.nx, at.nx) = body.weights.Q;
  if (at.past == 0) {
    all.plant.B.topRows(at.nx) = body.plant.B;
    w.R = body.weights.R;
    w.N.topRows(at.nx) = body.weights.N;
  } else {
    // The oldest command acts now. The cost of a command is counted when it is computed: the sum
    // differs only by the cost of the commands from before the start.
    const Index oldest = at.past_at() + (at.past - 1) * at.nu;
    all.plant.A.block(0, oldest, at.nx, at.nu) = body.plant.B;
    for (Index j = 1; j < at.past; ++j)
      all.plant.A.block(at.past_at() + j * at.nu, at.past_at() + (j - 1) * at.nu, at.nu, at.nu)
          .setIdentity();
    all.plant.B.middleRows(at.past_at(), at.nu).setIdentity();
    w.R = options.dt * weights.R;
    w.Q.block(0, oldest, at.nx, at.nu) = body.weights.N;
    w.Q.block(oldest, 0, at.nu, at.nx) = body.weights.N.transpose();
    w.Q.block(oldest, oldest, at.nu, at.nu) = body.weights.R - w.R;
    for (Index j = 0; j < at.past; ++j)
      for (const Signal& input : model.plant.inputs)
        all.plant.states.push_back({fmt::format("{}[k-{}]", input.name, j + 1), input.unit});
  }
  const std::vector<Index> integrated = integrated_states(options);
  for (Index i = 0; i < at.ni; ++i) {
    const Index row = at.integrals_at() + i, state = integrated[static_cast<std::size_t>(i)];
    all.plant.A(row, row) = 1;
    all.plant.A(row, state) = options.dt;
    const Signal& signal = model.plant.states[static_cast<std::size_t>(state)];
    all.plant.states.push_back({"int_" + signal.name, signal.unit + " s"});
  }
  if (at.ni > 0) w.Q.bottomRightCorner(at.ni, at.ni) = options.dt * weights.Q_integral;
  if (weights.R_change.size() > 0) {
    // Δu = u - u[k-1]
    w.R += weights.R_change;
    w.Q.block(at.past_at(), at.past_at(), at.nu, at.nu) += weights.R_change;
    w.N.middleRows(at.past_at(), at.nu) -= weights.R_change;
  }
  return all;
}

/// @param K  of u = -K z
Gains gains_of(const Vehicle& vehicle, const ActuatorModel& model,
               const ActuatorLqiOptions& options, const Layout& at, const MatrixXd& K) {
  Gains gains;
  gains.states = ned_convention().states;
  gains.inputs = model.plant.inputs;
  for (const std::string& name : options.integrals)
    for (const Signal& state : gains.states)
      if (state.name == name) gains.integrals.push_back({name, state.unit + " s"});
  gains.K = K.leftCols(12);
  gains.K_int = K.middleCols(at.integrals_at(), at.ni);
  // The law advances its integral before it uses it, i[k+1] = i[k] + dt x[k], so that the
  // contribution of x[k] to the integral must not be counted twice.
  const std::vector<Index> integrated = integrated_states(options);
  for (Index i = 0; i < at.ni; ++i)
    gains.K.col(integrated[static_cast<std::size_t>(i)]) -= options.dt * gains.K_int.col(i);
  gains.x0 = model.hover.x0;
  gains.u0 = model.hover.u0;
  gains.vehicle = vehicle.name;
  gains.convention = "ned";
  gains.input_kind = options.inputs;
  gains.sign_law = SignLaw::set_point_minus_state;
  gains.dt = options.dt;
  gains.axes = PositionAxes::heading;
  if (model.lag.size() == 0 && at.past == 0) return gains;
  CommandMemory memory;
  memory.past = static_cast<int>(at.past);
  memory.K_past = K.middleCols(at.past_at(), at.past * at.nu);
  // Without lag the actuator state equals its command. CommandMemory requires a lag, which is then
  // not used.
  const bool lagging = model.lag.size() > 0;
  memory.lag = lagging ? model.lag : VectorXd::Constant(at.nu, options.dt);
  memory.K_lag = lagging ? MatrixXd(K.middleCols(12, at.nu)) : MatrixXd::Zero(at.nu, at.nu);
  gains.memory = memory;
  return gains;
}

}  // namespace

ActuatorModel actuator_model(const Vehicle& vehicle, InputKind inputs) {
  ActuatorModel model;
  LinearizeOptions options;
  options.inputs = inputs;
  model.hover = linearize(vehicle, FlightCondition{}, options);
  if (!model.hover.solved())
    throw InvalidInput(kWhere, fmt::format("'{}' cannot hover: {}, expected a vehicle that can",
                                           vehicle.name, model.hover.trim.culprit));
  model.plant = model.hover.plant;
  model.lag = lags(vehicle, inputs);
  if (model.lag.size() == 0) return model;
  // ẋ = A x + B m + b ṁ, ṁ = (u - m)/lag, where b is the reaction torque of accelerating rotors.
  options.inputs = InputKind::wrench;
  const Linearization wrench = linearize(vehicle, model.hover.trim, options);
  const MatrixXd b = wrench.plant.B.col(3) * reaction(vehicle, model.hover.trim.u, inputs);
  const Index nu = model.lag.size();
  const MatrixXd rate = model.lag.cwiseInverse().asDiagonal();
  ContinuousLti& plant = model.plant;
  plant.A = MatrixXd::Zero(12 + nu, 12 + nu);
  plant.A << model.hover.plant.A, model.hover.plant.B - b * rate, MatrixXd::Zero(nu, 12), -rate;
  plant.B = MatrixXd(12 + nu, nu);
  plant.B << b * rate, rate;
  plant.C.resize(0, 0);
  plant.D.resize(0, 0);
  for (const Signal& input : plant.inputs)
    plant.states.push_back({"lag_" + input.name, input.unit});
  plant.outputs.clear();
  return model;
}

ActuatorLqi actuator_lqi(const Vehicle& vehicle, const ActuatorModel& model,
                         const ActuatorLqiWeights& weights, const ActuatorLqiOptions& options) {
  const Layout at{model.plant.A.rows(), model.plant.B.cols(), options.past,
                  std::ssize(options.integrals)};
  require(weights, options, at.nu);
  const SampledLqr problem = augmented(model, weights, options, at);
  ActuatorLqi result;
  result.model = problem.plant;
  result.riccati = lqr(problem.plant, problem.weights, options.riccati);
  const MatrixXd K =
      result.solved() ? result.riccati.K : MatrixXd::Constant(at.nu, at.size(), std::nan(""));
  result.gains = gains_of(vehicle, model, options, at, K);
  return result;
}

ActuatorLqi actuator_lqi(const Vehicle& vehicle, const ActuatorLqiWeights& weights,
                         const ActuatorLqiOptions& options) {
  return actuator_lqi(vehicle, actuator_model(vehicle, options.inputs), weights, options);
}

}  // namespace quadtune
