// SPDX-License-Identifier: Apache-2.0
#include "arguments/lqr_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "arguments/matrix_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune::cli {
namespace {

/// The weights of the states, then of the integrals, from one list; one number stands for all.
void read_weights(const LqrArguments& arguments, LqrDesign& design) {
  std::vector<std::string> weighted = design.states;
  for (const std::string& name : design.integrals) weighted.push_back("int_" + name);
  const Eigen::MatrixXd Q = diagonal_weights(
      arguments.Q.empty() ? "1" : arguments.Q, weighted.size(),
      fmt::format("states: {}", internal::joined(weighted, " ")), arguments.verb, "--Q");
  const auto nx = static_cast<Eigen::Index>(design.states.size());
  design.Q = Q.topLeftCorner(nx, nx);
  design.Q_integral = Q.bottomRightCorner(Q.rows() - nx, Q.rows() - nx);
  design.R = diagonal_weights(arguments.R.empty() ? "1" : arguments.R, design.inputs.size(),
                              fmt::format("inputs: {}", internal::joined(design.inputs, " ")),
                              arguments.verb, "--R");
}

}  // namespace

std::vector<std::string> read_integrals(const LqrArguments& arguments,
                                        const std::vector<std::string>& states) {
  const std::string& verb = arguments.verb;
  if (arguments.integral == "none") return {};
  std::vector<std::string> names = word_list(arguments.integral);
  for (const std::string& name : names) {
    if (std::find(states.begin(), states.end(), name) == states.end())
      throw UsageError(
          fmt::format("quadtune {}: --integral: no state '{}', expected some of {}{}", verb, name,
                      internal::joined(states, " "), internal::did_you_mean(name, states)),
          "--integral");
    if (std::count(names.begin(), names.end(), name) > 1)
      throw UsageError(
          fmt::format("quadtune {}: --integral: state '{}' is named twice, expected each once",
                      verb, name),
          "--integral");
  }
  return names;
}

LqrDesign make_design(const LqrArguments& arguments, const std::vector<Signal>& states,
                      const std::vector<Signal>& inputs) {
  LqrDesign design;
  design.convention = arguments.plant.convention;
  design.input_kind = input_kind(arguments.plant.inputs, "--inputs");
  design.method = lqr_method(arguments.method, "--method");
  design.dt = arguments.dt;
  if (design.method != LqrMethod::continuous && !arguments.has_dt)
    throw UsageError(
        fmt::format("quadtune {}: --dt is missing, expected a sample period with --method {}",
                    arguments.verb, arguments.method),
        "--dt");
  if (arguments.has_dt) require_positive(arguments.dt, arguments.verb, "--dt");
  for (const Signal& state : states) design.states.push_back(state.name);
  for (const Signal& input : inputs) design.inputs.push_back(input.name);
  design.integrals = read_integrals(arguments, design.states);
  read_weights(arguments, design);
  return design;
}

}  // namespace quadtune::cli
