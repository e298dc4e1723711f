// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/given_gains.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

Gains published_gains(const Design& design, const std::string& path) {
  const LqrDesign& lqr = *design.lqr;  // [published] requires [lqr]
  const PublishedGains& published = *design.published;
  if (published.K.rows() != std::ssize(lqr.inputs))
    throw InvalidInput(path, fmt::format("published.K has {}, expected {} (inputs: {}) because "
                                         "weights are computed from the whole gain",
                                         internal::counted(published.K.rows(), "row"),
                                         lqr.inputs.size(), internal::joined(lqr.inputs, " ")));
  Gains gains;
  gains.K = published.K;
  gains.K_int = published.K_int;
  gains.convention = lqr.convention;
  for (const std::string& name : lqr.states)
    for (const Signal& state : convention(lqr.convention, path).states)
      if (state.name == name) gains.states.push_back(state);
  gains.integrals = integral_signals(gains.states, lqr.integrals);
  for (const std::string& name : lqr.inputs) gains.inputs.push_back({name, ""});
  gains.x0 = Eigen::VectorXd::Zero(gains.K.cols());
  gains.u0 = Eigen::VectorXd::Zero(gains.K.rows());
  gains.vehicle = design.vehicle.name;
  gains.input_kind = lqr.input_kind;
  gains.dt = lqr.dt;
  return gains;
}

/// Rejects a schedule: it can be flown, but other uses require a single law.
void refuse_schedule(const std::string& path) {
  if (is_schedule(path) || holds_schedule(path))
    throw InvalidInput(path, "has gains for many trims; expected those of one law");
}

std::vector<std::string> names_of(const std::vector<Signal>& signals) {
  std::vector<std::string> result;
  result.reserve(signals.size());
  for (const Signal& signal : signals) result.push_back(signal.name);
  return result;
}

void require_same(const std::vector<std::string>& have, const std::vector<std::string>& want,
                  const std::string& what, const std::string& path) {
  if (std::is_permutation(have.begin(), have.end(), want.begin(), want.end())) return;
  throw InvalidInput(
      path, fmt::format("the gains have the {} '{}', expected '{}', which --{} selects", what,
                        internal::joined(have, " "), internal::joined(want, " "),
                        what == "integrals" ? "integral" : what));
}

/// Columns of M, named by `from`, reordered to the target order.
Eigen::MatrixXd ordered(const Eigen::MatrixXd& M, const std::vector<Signal>& from,
                        const std::vector<std::string>& to, const std::string& what,
                        const std::string& path) {
  const std::vector<std::string> have = names_of(from);
  require_same(have, to, what, path);
  Eigen::MatrixXd result(M.rows(), std::ssize(to));
  for (std::size_t j = 0; j < to.size(); ++j)
    result.col(static_cast<Eigen::Index>(j)) =
        M.col(std::find(have.begin(), have.end(), to[j]) - have.begin());
  return result;
}

}  // namespace

GivenLaws read_given_laws(const std::string& path) {
  refuse_schedule(path);
  GivenLaws given;
  if (!path.ends_with(".toml")) {
    given.laws = read_laws(path);
  } else {
    given.design = solve_laws(load_design(path));
    const DesignOutcome& outcome = *given.design;
    given.laws = {outcome.design.vehicle.name, outcome.gains, outcome.design.cascade};
    if (outcome.cascade) given.laws.cascade->gains = outcome.cascade->cascade.gains;
  }
  if (!given.laws.gains && !given.laws.cascade)
    throw InvalidInput(path, "has no control law; expected a state feedback or a PID cascade");
  return given;
}

void require_vehicle(const StoredLaws& laws, const Vehicle& vehicle, const std::string& path) {
  if (!laws.vehicle.empty() && laws.vehicle != vehicle.name)
    throw InvalidInput(path, fmt::format("the gains are for the vehicle '{}', expected '{}'",
                                         laws.vehicle, vehicle.name));
}

GivenGains read_given_gains(const std::string& path) {
  refuse_schedule(path);
  if (!path.ends_with(".toml")) return {read_gains(path), {}};
  const Design design = load_design(path);
  if (design.published) return {published_gains(design, path), design};
  if (!has_feedback(design))
    throw InvalidInput(path, "has no [lqr]; it is required because its gains are requested");
  return {*solve_laws(design).gains, design};
}

void require_states(const Gains& gains, const std::vector<Signal>& states, const Convention& words,
                    const std::string& path) {
  require_same(names_of(in_convention(gains, words).states), names_of(states), "states", path);
}

OrderedGains in_order_of(const Gains& gains, const Vehicle& vehicle, const LqrDesign& design,
                         const std::string& path) {
  if (!gains.vehicle.empty() && gains.vehicle != vehicle.name)
    throw InvalidInput(path, fmt::format("the gains are for the vehicle '{}', expected '{}'",
                                         gains.vehicle, vehicle.name));
  if (gains.input_kind != design.input_kind)
    throw InvalidInput(path,
                       fmt::format("the gains command {}, expected {}, which --inputs selects",
                                   to_string(gains.input_kind), to_string(design.input_kind)));
  const Gains turned = in_convention(gains, convention(design.convention, "--convention"));
  if (std::ssize(turned.inputs) != std::ssize(design.inputs))
    throw InvalidInput(
        path, fmt::format("the gains have {} inputs ({}), expected {} ({})", turned.inputs.size(),
                          names(turned.inputs), design.inputs.size(),
                          internal::joined(design.inputs, " ")));
  return {ordered(turned.K, turned.states, design.states, "states", path),
          ordered(turned.K_int, turned.integrals, design.integrals, "integrals", path)};
}

}  // namespace quadtune
