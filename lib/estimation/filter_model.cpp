// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/filter_model.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;

void require_distinct(const std::vector<Signal>& signals, const std::string& kind,
                      const std::string& where) {
  std::set<std::string> seen;
  for (const Signal& signal : signals) {
    if (signal.name.empty())
      throw InvalidInput(where, fmt::format("a {} has no name, expected a name for each", kind));
    if (!seen.insert(signal.name).second)
      throw InvalidInput(where, fmt::format("two {}s are called '{}', expected different names",
                                            kind, signal.name));
  }
}

void require_covariance(const Eigen::MatrixXd& M, const std::string& name,
                        const std::string& where) {
  require_finite(M, where, name);
  require_symmetric(M, where, name);
  if (M.size() == 0) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M, Eigen::EigenvaluesOnly);
  const double min = eigen.eigenvalues()(0);
  if (min < -1e-12 * M.cwiseAbs().maxCoeff())
    throw InvalidInput(where, fmt::format("{} has the eigenvalue {:.3g}, expected no negative one "
                                          "because it is a covariance",
                                          name, min));
}

void check_terms(const CovarianceModel& model, Index size, const std::string& name,
                 const FilterModel& of, std::vector<bool>& used, const std::string& where) {
  require_shape(model.fixed, size, size, where, "the fixed part of " + name, "one row per entry");
  require_covariance(model.fixed, "the fixed part of " + name, where);
  const auto count = static_cast<int>(of.parameters.size());
  const auto use = [&](int parameter, bool logarithmic) {
    if (parameter < 0 || parameter >= count)
      throw InvalidInput(
          where, fmt::format("{} uses parameter {}, expected 0 to {}", name, parameter, count - 1));
    const auto k = static_cast<std::size_t>(parameter);
    if (of.parameters[k].logarithmic != logarithmic)
      throw InvalidInput(where,
                         fmt::format("{} uses '{}' as {}, expected {}", name, of.parameters[k].name,
                                     logarithmic ? "a variance" : "an entry of a factor",
                                     logarithmic ? "an entry of a factor" : "a variance"));
    used[k] = true;
  };
  for (const ScaledCovariance& term : model.scaled) {
    require_shape(term.shape, size, size, where, "a part of " + name, "one row per entry");
    require_covariance(term.shape, "a part of " + name, where);
    use(term.parameter, true);
  }
  for (const FullCovariance& term : model.full) {
    int parameter = term.first_parameter;
    for (std::size_t i = 0; i < term.entries.size(); ++i) {
      if (term.entries[i] < 0 || term.entries[i] >= size)
        throw InvalidInput(where, fmt::format("{} has a block on entry {}, expected 0 to {}", name,
                                              term.entries[i], size - 1));
      for (std::size_t j = 0; j <= i; ++j) use(parameter++, i == j);
    }
  }
}

void check_robustness(const FilterSensor& sensor, const std::string& of, const std::string& where) {
  if (sensor.student != 0 && !(sensor.student > 2 && sensor.student <= 1000))
    throw InvalidInput(where, fmt::format("student of {} is {}, expected 0, or more than 2 and at "
                                          "most 1000 degrees of freedom",
                                          of, sensor.student));
  if (sensor.student != 0 && !is_diagonal(sensor.R))
    throw InvalidInput(where, fmt::format("student of {} is {}, expected 0 because its outputs' "
                                          "noise is correlated",
                                          of, sensor.student));
  if (!(sensor.gate >= 4))
    throw InvalidInput(
        where, fmt::format("the gate of {} is {}, expected at least 4, two standard "
                           "deviations, because a smaller gate rejects many correct measurements",
                           of, sensor.gate));
}

void check_parameters(const FilterModel& model, const std::string& where) {
  std::set<std::string> seen;
  for (const NoiseParameter& p : model.parameters) {
    if (p.name.empty() || !seen.insert(p.name).second)
      throw InvalidInput(where, fmt::format("a parameter is called '{}', expected different names "
                                            "that are not empty",
                                            p.name));
    if (!std::isfinite(p.start) || (p.logarithmic && !(p.start > 0)))
      throw InvalidInput(where, fmt::format("the start of '{}' is {}, expected {}", p.name, p.start,
                                            p.logarithmic ? "a positive number" : "a number"));
    if (p.prior && (!(p.prior->median > 0) || !(p.prior->deviation > 0) || !p.logarithmic))
      throw InvalidInput(
          where, fmt::format("the prior of '{}' has the median {} and the deviation {}, expected "
                             "positive numbers, of a variance",
                             p.name, p.prior->median, p.prior->deviation));
  }
}

}  // namespace

Index FilterModel::outputs() const {
  Index count = 0;
  for (const FilterSensor& sensor : sensors) count += sensor.C.rows();
  return count;
}

Eigen::VectorXd start_of(const FilterModel& model) {
  Eigen::VectorXd theta(static_cast<Index>(model.parameters.size()));
  for (Index i = 0; i < theta.size(); ++i) {
    const NoiseParameter& p = model.parameters[static_cast<std::size_t>(i)];
    theta(i) = p.logarithmic ? std::log(p.start) : p.start;
  }
  return theta;
}

int parameter_index(const FilterModel& model, const std::string& name, const std::string& where) {
  std::vector<std::string> known;
  for (const NoiseParameter& p : model.parameters) known.push_back(p.name);
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    throw InvalidInput(
        where, fmt::format("no parameter '{}', expected one of {}{}", name,
                           internal::joined(known, ", "), internal::did_you_mean(name, known)));
  return static_cast<int>(found - known.begin());
}

void validate(const FilterModel& model, const std::string& where) {
  const auto nx = static_cast<Index>(model.states.size());
  const auto nu = static_cast<Index>(model.inputs.size());
  const auto nw = static_cast<Index>(model.noises.size());
  if (nx < 1) throw InvalidInput(where, "the model has no states, expected at least one");
  if (!(model.dt >= 0) || !std::isfinite(model.dt))
    throw InvalidInput(where,
                       fmt::format("the period is {} s, expected a positive number, or 0 for "
                                   "a continuous model",
                                   model.dt));
  require_distinct(model.states, "state", where);
  require_distinct(model.inputs, "input", where);
  require_distinct(model.noises, "noise", where);
  require_shape(model.A, nx, nx, where, "A", "one row and column per state");
  require_shape(model.B, nx, nu, where, "B", "one row per state, one column per input");
  require_shape(model.G, nx, nw, where, "G", "one row per state, one column per noise");
  for (const auto& [matrix, name] :
       {std::pair(&model.A, "A"), std::pair(&model.B, "B"), std::pair(&model.G, "G")})
    require_finite(*matrix, where, name);
  if (model.sensors.empty())
    throw InvalidInput(where, "the model has no sensors, expected at least one");

  check_parameters(model, where);
  std::vector<bool> used(model.parameters.size(), false);
  check_terms(model.Q, nw, "Q", model, used, where);
  const Eigen::VectorXd theta = start_of(model);
  std::vector<Signal> all;
  std::set<std::string> sensors;
  for (const FilterSensor& sensor : model.sensors) {
    const std::string of = fmt::format("sensor '{}'", sensor.name);
    if (sensor.name.empty() || !sensors.insert(sensor.name).second)
      throw InvalidInput(where,
                         fmt::format("a sensor is called '{}', expected different names that "
                                     "are not empty",
                                     sensor.name));
    const auto ny = static_cast<Index>(sensor.outputs.size());
    if (ny < 1) throw InvalidInput(where, of + " has no outputs, expected at least one");
    all.insert(all.end(), sensor.outputs.begin(), sensor.outputs.end());
    require_shape(sensor.C, ny, nx, where, "C of " + of,
                  "one row per output, one column per state");
    require_finite(sensor.C, where, "C of " + of);
    for (Index i = 0; i < ny; ++i)
      if (sensor.C.row(i).isZero(0))
        throw InvalidInput(where, fmt::format("C of {} has only zeros in row {}, expected a "
                                              "measurement that depends on a state",
                                              of, i + 1));
    if (sensor.D.size() > 0) {
      require_shape(sensor.D, ny, nu, where, "D of " + of,
                    "one row per output, one column per input");
      require_finite(sensor.D, where, "D of " + of);
    }
    check_terms(sensor.R, ny, "R of " + of, model, used, where);
    const Eigen::MatrixXd R = covariance(sensor.R, theta);
    if (!(R.llt().info() == Eigen::Success))
      throw InvalidInput(
          where,
          fmt::format(
              "R of {} is not positive definite at the initial values of its parameters, expected "
              "every measurement to have some noise",
              of));
    check_robustness(sensor, of, where);
    if (!(sensor.delay >= 0) || !std::isfinite(sensor.delay))
      throw InvalidInput(
          where, fmt::format("the delay of {} is {} s, expected 0 or more", of, sensor.delay));
  }
  require_distinct(all, "output", where);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i])
      throw InvalidInput(where,
                         fmt::format("parameter '{}' is not used, expected a covariance that "
                                     "depends on it",
                                     model.parameters[i].name));

  require_shape(model.x0, nx, 1, where, "the initial state", "one entry per state");
  require_finite(model.x0, where, "the initial state");
  require_shape(model.P0, nx, nx, where, "the initial covariance", "one row per state");
  require_covariance(model.P0, "the initial covariance", where);
  if (static_cast<Index>(model.diffuse.size()) != nx)
    throw InvalidInput(
        where, fmt::format("diffuse has {}, expected {}, one per state",
                           internal::counted(model.diffuse.size(), "entry", "entries"), nx));
  for (Index i = 0; i < nx; ++i)
    if (model.diffuse[static_cast<std::size_t>(i)] && !model.P0.row(i).isZero(0))
      throw InvalidInput(where, fmt::format("state '{}' is diffuse and has an initial covariance, "
                                            "expected one or the other",
                                            model.states[static_cast<std::size_t>(i)].name));
}

}  // namespace quadtune
