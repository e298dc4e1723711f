// SPDX-License-Identifier: Apache-2.0
#include "arguments/lqr_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "arguments/matrix_arguments.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune::cli {

std::vector<std::string> read_integrals(const LqrArguments& arguments,
                                        const std::vector<std::string>& states) {
  if (arguments.integral == "none") return {};
  std::vector<std::string> names = word_list(arguments.integral);
  for (const std::string& name : names) {
    if (std::find(states.begin(), states.end(), name) == states.end())
      refuse("--integral", "--integral: unknown state '{}'; expected names from {}{}", name,
             internal::joined(states, " "), internal::did_you_mean(name, states));
    if (std::count(names.begin(), names.end(), name) > 1)
      refuse("--integral", "--integral: state '{}' is listed twice; expected once", name);
  }
  return names;
}

Eigen::VectorXd state_weights(const std::string& list, const std::vector<std::string>& states,
                              const std::vector<std::string>& integrals) {
  std::vector<std::string> weighted = states;
  for (const std::string& name : integrals) weighted.push_back("int_" + name);
  return diagonal_weights(list, weighted.size(),
                          fmt::format("states: {}", internal::joined(weighted, " ")), "--Q")
      .diagonal();
}

Eigen::VectorXd input_weights(const std::string& list, const std::vector<std::string>& inputs,
                              const std::string& option) {
  return diagonal_weights(list, inputs.size(),
                          fmt::format("inputs: {}", internal::joined(inputs, " ")), option)
      .diagonal();
}

LqrDesign make_design(const LqrArguments& arguments, const std::vector<Signal>& states,
                      const std::vector<Signal>& inputs) {
  LqrDesign design;
  design.convention = named_convention(arguments.plant.convention, "--convention").name;
  design.input_kind = input_kind(arguments.plant.inputs, "--inputs");
  design.method = lqr_method(arguments.method, "--method");
  design.dt = arguments.dt.value_or(0);
  if (design.method != LqrMethod::continuous && !arguments.dt)
    refuse("--dt", "--dt is missing, expected a sample period with --method {}", arguments.method);
  if (arguments.dt) require_positive(*arguments.dt, "--dt");
  design.states = names_or_numbers(states, std::ssize(states));
  design.inputs = names_or_numbers(inputs, std::ssize(inputs));
  design.integrals = read_integrals(arguments, design.states);
  // Without a list, all weights are 1.
  const auto or_ones = [](const std::string& list) { return list.empty() ? "1" : list; };
  const Eigen::VectorXd Q = state_weights(or_ones(arguments.Q), design.states, design.integrals);
  const auto nx = static_cast<Eigen::Index>(design.states.size());
  design.Q = Q.head(nx).asDiagonal();
  design.Q_integral = Q.tail(Q.size() - nx).asDiagonal();
  design.R = input_weights(or_ones(arguments.R), design.inputs, "--R").asDiagonal();
  return design;
}

}  // namespace quadtune::cli
