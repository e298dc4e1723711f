// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/convert.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

// For each column of the target, its column in the source and its sign.
struct Map {
  std::vector<int> source;
  std::vector<double> sign;
  std::vector<Signal> signals;
};

Eigen::Index row_of(const std::string& name, const Convention& convention) {
  for (std::size_t i = 0; i < convention.states.size(); ++i)
    if (convention.states[i].name == name) return static_cast<Eigen::Index>(i);
  throw InvalidInput("in_convention", fmt::format("no state '{}' in convention {}, expected {}",
                                                  name, convention.name, names(convention.states)));
}

// The matrix that orders inputs as the wrench of a convention.
Eigen::MatrixXd order_of(const std::vector<Signal>& inputs, const Convention& convention) {
  const auto n = static_cast<Eigen::Index>(convention.wrench.size());
  Eigen::MatrixXd order = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t j = 0; j < inputs.size(); ++j)
    for (Eigen::Index i = 0; i < n; ++i)
      if (convention.wrench[static_cast<std::size_t>(i)].name == inputs[j].name)
        order(i, static_cast<Eigen::Index>(j)) = 1;
  if (inputs.size() != convention.wrench.size() || (order.rowwise().sum().array() != 1).any())
    throw InvalidInput("in_convention",
                       fmt::format("the inputs are {}, expected {} because they are the wrench in "
                                   "convention {}",
                                   names(inputs), names(convention.wrench), convention.name));
  return order;
}

Map map_states(const std::vector<Signal>& signals, const Convention& from, const Convention& to) {
  // x_to = T x_from
  const Eigen::Matrix<double, 12, 12> T = to.from_ned * from.from_ned.transpose();
  Map map;
  for (Eigen::Index i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < signals.size(); ++j) {
      const double sign = T(i, row_of(signals[j].name, from));
      if (sign == 0) continue;
      map.source.push_back(static_cast<int>(j));
      map.sign.push_back(sign);
      map.signals.push_back({to.states[static_cast<std::size_t>(i)].name, signals[j].unit});
    }
  return map;
}

Eigen::MatrixXd map_columns(const Eigen::MatrixXd& K, const Map& map) {
  Eigen::MatrixXd result(K.rows(), static_cast<Eigen::Index>(map.source.size()));
  for (Eigen::Index j = 0; j < result.cols(); ++j) {
    const auto k = static_cast<std::size_t>(j);
    result.col(j) = map.sign[k] * K.col(map.source[k]);
  }
  return result;
}

}  // namespace

CommandMemory in_inputs(const CommandMemory& memory, const Eigen::MatrixXd& W) {
  CommandMemory result = memory;
  result.lag = W.cwiseAbs() * memory.lag;
  result.K_lag = W * memory.K_lag * W.transpose();
  const Eigen::Index nu = W.rows();
  for (Eigen::Index k = 0; k < memory.past; ++k)
    result.K_past.middleCols(k * nu, nu) = W * memory.K_past.middleCols(k * nu, nu) * W.transpose();
  return result;
}

Gains in_convention(const Gains& gains, const Convention& target, SignLaw sign_law) {
  validate(gains, "in_convention");
  const Convention& source = convention(gains.convention, "in_convention");
  const Map states = map_states(gains.states, source, target);
  const Map integrals = map_states(gains.integrals, source, target);
  Gains result = gains;
  result.convention = target.name;
  result.sign_law = sign_law;
  result.states = states.signals;
  result.integrals = integrals.signals;
  const double law = sign_law == gains.sign_law ? 1 : -1;
  result.K = law * map_columns(gains.K, states);
  result.K_int = law * map_columns(gains.K_int, integrals);
  result.x0 = map_columns(gains.x0.transpose(), states).transpose();
  if (gains.input_kind == InputKind::wrench) {
    // u_to = W u_from, with u_from in the order of the gains
    const Eigen::MatrixXd W = target.wrench_from_ned * source.wrench_from_ned.transpose() *
                              order_of(gains.inputs, source);
    result.inputs = target.wrench;
    result.K = W * result.K;
    result.K_int = W * result.K_int;
    result.u0 = W * gains.u0;
    if (gains.memory) result.memory = in_inputs(*gains.memory, W);
  }
  return result;
}

}  // namespace quadtune
