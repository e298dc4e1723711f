// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

std::vector<std::string> only_in(const std::vector<Signal>& a, const std::vector<Signal>& b) {
  std::vector<std::string> result;
  for (const Signal& signal : a)
    if (std::none_of(b.begin(), b.end(), [&](const Signal& s) { return s.name == signal.name; }))
      result.push_back(signal.name);
  return result;
}

void require_same_signals(const std::vector<Signal>& a, const std::vector<Signal>& b,
                          const std::string& what) {
  const std::vector<std::string> first = only_in(a, b);
  const std::vector<std::string> second = only_in(b, a);
  if (!first.empty() || !second.empty())
    throw InvalidInput(
        "diff", fmt::format("the gains have different {} (only in the first: {}; "
                            "only in the second: {}), expected the same, because "
                            "gains are only comparable with the same set of signals",
                            what, internal::joined(first, " "), internal::joined(second, " ")));
  for (const Signal& x : a)
    for (const Signal& y : b)
      if (x.name == y.name && x.unit != y.unit)
        throw InvalidInput("diff", fmt::format("{} is in '{}' in the first and in '{}' in the "
                                               "second, expected the same unit",
                                               x.name, x.unit, y.unit));
}

// Columns of M, named by `from`, reordered to `to`.
Eigen::MatrixXd in_order(const Eigen::MatrixXd& M, const std::vector<Signal>& from,
                         const std::vector<Signal>& to) {
  Eigen::MatrixXd result(M.rows(), static_cast<Eigen::Index>(to.size()));
  for (std::size_t j = 0; j < to.size(); ++j)
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i].name == to[j].name)
        result.col(static_cast<Eigen::Index>(j)) = M.col(static_cast<Eigen::Index>(i));
  return result;
}

// Rows of M, named by `from`, reordered to `to`.
Eigen::MatrixXd rows_in_order(const Eigen::MatrixXd& M, const std::vector<Signal>& from,
                              const std::vector<Signal>& to) {
  return in_order(M.transpose(), from, to).transpose();
}

// The loop with this axis; all gains 0 if the cascade has no such loop.
PidLoop loop_of(const CascadeGains& gains, CascadeAxis axis) {
  for (const PidLoop& loop : gains.loops)
    if (loop.name == to_string(axis)) return loop;
  return cascade_loop(axis);
}

// Compares one number of a cascade. Infinite means that there is no limit.
void compare(const std::string& matrix, const std::string& loop, double a, double b,
             GainsDiff& result) {
  if (a == b) return;
  const double scale = std::max(std::abs(a), std::abs(b));
  const double relative = std::isfinite(scale) ? std::abs(b - a) / scale : 1;
  result.entries.push_back({matrix, loop, "", a, b, b - a, relative});
}

void sort_entries(GainsDiff& result) {
  std::stable_sort(result.entries.begin(), result.entries.end(),
                   [](const DiffEntry& x, const DiffEntry& y) { return x.relative > y.relative; });
  if (!result.entries.empty()) result.max_relative = result.entries.front().relative;
}

void compare(const std::string& matrix, const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
             const std::vector<Signal>& inputs, const std::vector<Signal>& columns,
             GainsDiff& result) {
  if (A.size() == 0) return;
  const Eigen::MatrixXd size = A.cwiseAbs().cwiseMax(B.cwiseAbs());
  const Eigen::VectorXd row = size.rowwise().maxCoeff();
  const Eigen::RowVectorXd column = size.colwise().maxCoeff();
  const double min = 1e-13 * size.maxCoeff();
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      if (A(i, j) == B(i, j)) continue;
      const double difference = B(i, j) - A(i, j);
      const double scale = std::max(std::min(row(i), column(j)), min);
      result.entries.push_back({matrix, inputs[static_cast<std::size_t>(i)].name,
                                columns[static_cast<std::size_t>(j)].name, A(i, j), B(i, j),
                                difference, std::abs(difference) / scale});
    }
}

/// Columns of K_past: the inputs of the last command, of the one before it, …
std::vector<Signal> past_commands(const std::vector<Signal>& inputs, int past) {
  std::vector<Signal> all;
  for (int k = 1; k <= past; ++k)
    for (const Signal& input : inputs)
      all.push_back({fmt::format("{}[-{}]", input.name, k), input.unit});
  return all;
}

/// Compares axes, limits and memory. A law without memory is compared as a law whose memory gains
/// are 0, without past commands and with a lag of 0.
void compare_dynamics(const Gains& a, const Gains& b, GainsDiff& result) {
  compare("heading_axes", "", a.axes == PositionAxes::heading ? 1 : 0,
          b.axes == PositionAxes::heading ? 1 : 0, result);
  compare("position_error_m", "", a.limits.position_error, b.limits.position_error, result);
  compare("conditional_integration", "", a.limits.conditional_integration ? 1 : 0,
          b.limits.conditional_integration ? 1 : 0, result);
  if (!a.memory && !b.memory) return;
  const Eigen::Index nu = a.K.rows();
  const CommandMemory none{Eigen::VectorXd::Zero(nu), Eigen::MatrixXd::Zero(nu, nu), 0,
                           Eigen::MatrixXd::Zero(nu, 0)};
  Eigen::MatrixXd order(nu, nu);
  for (Eigen::Index i = 0; i < nu; ++i)
    for (Eigen::Index j = 0; j < nu; ++j)
      order(i, j) =
          a.inputs[static_cast<std::size_t>(i)].name == b.inputs[static_cast<std::size_t>(j)].name
              ? 1
              : 0;
  const CommandMemory x = a.memory ? *a.memory : none;
  const CommandMemory y = b.memory ? in_inputs(*b.memory, order) : none;
  compare("past", "", x.past, y.past, result);
  for (Eigen::Index i = 0; i < nu; ++i)
    compare("lag_s", a.inputs[static_cast<std::size_t>(i)].name, x.lag(i), y.lag(i), result);
  compare("K_lag", x.K_lag, y.K_lag, a.inputs, a.inputs, result);
  const int past = std::max(x.past, y.past);
  const auto padded = [&](const CommandMemory& memory) {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(nu, past * nu);
    K.leftCols(memory.K_past.cols()) = memory.K_past;
    return K;
  };
  compare("K_past", padded(x), padded(y), a.inputs, past_commands(a.inputs, past), result);
}

}  // namespace

GainsDiff diff(const Gains& a, const Gains& b) {
  validate(a, "diff: first");
  if (a.input_kind != b.input_kind)
    throw InvalidInput("diff", fmt::format("the gain of A commands {}, that of B {}, expected "
                                           "the same kind of inputs",
                                           to_string(a.input_kind), to_string(b.input_kind)));
  const Gains turned = in_convention(b, convention(a.convention, "diff: first"), a.sign_law);
  require_same_signals(a.inputs, turned.inputs, "inputs");
  require_same_signals(a.states, turned.states, "states");
  require_same_signals(a.integrals, turned.integrals, "integrals");
  GainsDiff result;
  // By name, rows as well as columns: a gain with other names is another gain.
  const auto as_first = [&](const Eigen::MatrixXd& M, const std::vector<Signal>& columns,
                            const std::vector<Signal>& wanted) {
    return rows_in_order(in_order(M, columns, wanted), turned.inputs, a.inputs);
  };
  compare("K", a.K, as_first(turned.K, turned.states, a.states), a.inputs, a.states, result);
  compare("K_int", a.K_int, as_first(turned.K_int, turned.integrals, a.integrals), a.inputs,
          a.integrals, result);
  compare_dynamics(a, turned, result);
  sort_entries(result);
  return result;
}

GainsDiff diff(const CascadeDesign& a, const CascadeDesign& b) {
  GainsDiff result;
  compare("dt_s", "", a.gains.dt, b.gains.dt, result);
  compare("integrator", "", static_cast<double>(a.method), static_cast<double>(b.method), result);
  compare("attitude_limit_rad", "", a.attitude_limit, b.attitude_limit, result);
  compare("integrator_limit", "", a.integrator_limit, b.integrator_limit, result);
  compare("back_calculation_per_s", "", a.back_calculation, b.back_calculation, result);
  compare("takeoff_time_s", "", a.takeoff_time, b.takeoff_time, result);
  compare("velocity_feed_forward", "", a.velocity_feed_forward ? 1 : 0,
          b.velocity_feed_forward ? 1 : 0, result);
  compare("conditional_integration", "", a.conditional_integration ? 1 : 0,
          b.conditional_integration ? 1 : 0, result);
  for (const CascadeAxis axis : kAllCascadeAxes) {
    const std::string name = to_string(axis);
    const PidLoop x = loop_of(a.gains, axis);
    const PidLoop y = loop_of(b.gains, axis);
    compare("Kp", name, x.Kp, y.Kp, result);
    compare("Ki", name, x.Ki, y.Ki, result);
    compare("Kd", name, x.Kd, y.Kd, result);
    compare("rate_lead_s", name, x.rate_lead, y.rate_lead, result);
    compare("rate_filter_s", name, x.rate_filter, y.rate_filter, result);
  }
  sort_entries(result);
  return result;
}

std::string name_of(const DiffEntry& entry) {
  if (entry.input.empty()) return entry.matrix;
  return fmt::format("{}({}{}{})", entry.matrix, entry.input, entry.state.empty() ? "" : ", ",
                     entry.state);
}

}  // namespace quadtune
