// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/diff.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"

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
    throw InvalidInput("diff", fmt::format("the gains have different {} (only in the first: {}; "
                                           "only in the second: {}), expected the same, because "
                                           "a gain has no meaning without its others",
                                           what, fmt::join(first, " "), fmt::join(second, " ")));
  for (const Signal& x : a)
    for (const Signal& y : b)
      if (x.name == y.name && x.unit != y.unit)
        throw InvalidInput("diff", fmt::format("{} is in '{}' in the first and in '{}' in the "
                                               "second, expected the same unit",
                                               x.name, x.unit, y.unit));
}

// Columns of M, named by `from`, in the order of `to`.
Eigen::MatrixXd in_order(const Eigen::MatrixXd& M, const std::vector<Signal>& from,
                         const std::vector<Signal>& to) {
  Eigen::MatrixXd result(M.rows(), static_cast<Eigen::Index>(to.size()));
  for (std::size_t j = 0; j < to.size(); ++j)
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i].name == to[j].name)
        result.col(static_cast<Eigen::Index>(j)) = M.col(static_cast<Eigen::Index>(i));
  return result;
}

// Rows of M, named by `from`, in the order of `to`.
Eigen::MatrixXd rows_in_order(const Eigen::MatrixXd& M, const std::vector<Signal>& from,
                              const std::vector<Signal>& to) {
  return in_order(M.transpose(), from, to).transpose();
}

// Gains 0 where the cascade has no such loop.
PidLoop loop_of(const CascadeGains& gains, CascadeAxis axis) {
  for (const PidLoop& loop : gains.loops)
    if (loop.name == to_string(axis)) return loop;
  return cascade_loop(axis);
}

// One number of a cascade. Infinite stands for a limit that there is not.
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
  const double least = 1e-13 * size.maxCoeff();
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      if (A(i, j) == B(i, j)) continue;
      const double difference = B(i, j) - A(i, j);
      const double scale = std::max(std::min(row(i), column(j)), least);
      result.entries.push_back({matrix, inputs[static_cast<std::size_t>(i)].name,
                                columns[static_cast<std::size_t>(j)].name, A(i, j), B(i, j),
                                difference, std::abs(difference) / scale});
    }
}

}  // namespace

GainsDiff diff(const Gains& a, const Gains& b) {
  validate(a, "diff: first");
  if (a.input_kind != b.input_kind)
    throw InvalidInput("diff", fmt::format("the first gain commands {}, the second {}, expected "
                                           "the same kind of inputs",
                                           to_string(a.input_kind), to_string(b.input_kind)));
  const Gains turned = in_convention(b, convention(a.convention, "diff: first"), a.sign_law);
  require_same_signals(a.inputs, turned.inputs, "inputs");
  require_same_signals(a.states, turned.states, "states");
  require_same_signals(a.integrals, turned.integrals, "integrals");
  GainsDiff result;
  // By name, rows as well as columns: a gain under other names is another gain.
  const auto as_first = [&](const Eigen::MatrixXd& M, const std::vector<Signal>& columns,
                            const std::vector<Signal>& wanted) {
    return rows_in_order(in_order(M, columns, wanted), turned.inputs, a.inputs);
  };
  compare("K", a.K, as_first(turned.K, turned.states, a.states), a.inputs, a.states, result);
  compare("K_int", a.K_int, as_first(turned.K_int, turned.integrals, a.integrals), a.inputs,
          a.integrals, result);
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
  for (const CascadeAxis axis : kAllCascadeAxes) {
    const std::string name = to_string(axis);
    const PidLoop x = loop_of(a.gains, axis);
    const PidLoop y = loop_of(b.gains, axis);
    compare("Kp", name, x.Kp, y.Kp, result);
    compare("Ki", name, x.Ki, y.Ki, result);
    compare("Kd", name, x.Kd, y.Kd, result);
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
