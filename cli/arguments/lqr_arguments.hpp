// SPDX-License-Identifier: Apache-2.0
/// Options of an LQR problem about a vehicle's trim.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arguments/plant_arguments.hpp"
#include "quadtune/design.hpp"
#include "quadtune/lti.hpp"

namespace quadtune::cli {

struct LqrArguments {
  PlantArguments plant;
  std::string Q, R;      // lists; 1 if empty
  std::string integral;  // names, or "none"
  std::string method = "continuous";
  std::optional<double> dt;  // [s]
  std::string verb = "lqr";  // that asks, for messages
};

/// The names of --integral, each a state of the model and named once; "none" gives none.
/// @throws UsageError  naming the option, what came and what was expected.
[[nodiscard]] std::vector<std::string> read_integrals(const LqrArguments& arguments,
                                                      const std::vector<std::string>& states);

/// The diagonal of the weights of states, then of integrals, from a list; one number stands for
/// all.
/// @throws UsageError  naming --Q, what came and what was expected.
[[nodiscard]] Eigen::VectorXd state_weights(const std::string& list,
                                            const std::vector<std::string>& states,
                                            const std::vector<std::string>& integrals,
                                            const std::string& verb);

/// The same of inputs.
/// @param option  e.g. "--R"
[[nodiscard]] Eigen::VectorXd input_weights(const std::string& list,
                                            const std::vector<std::string>& inputs,
                                            const std::string& verb, const std::string& option);

/// The problem for a model with these states and inputs.
/// @throws UsageError  naming the option, what came and what was expected.
[[nodiscard]] LqrDesign make_design(const LqrArguments& arguments,
                                    const std::vector<Signal>& states,
                                    const std::vector<Signal>& inputs);

}  // namespace quadtune::cli
