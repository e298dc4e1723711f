// SPDX-License-Identifier: Apache-2.0
/// Options of an LQR problem at a trim of a vehicle.
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
  std::string Q, R;      // lists; empty: all weights are 1
  std::string integral;  // names, or "none"
  std::string method = "continuous";
  std::optional<double> dt;  // [s]
};

/// The names of --integral. Each must be a state of the model and be listed once; "none" gives no
/// names.
/// @throws UsageError  naming the option, its value and what was expected.
[[nodiscard]] std::vector<std::string> read_integrals(const LqrArguments& arguments,
                                                      const std::vector<std::string>& states);

/// The diagonal of the weights of the states, followed by those of the integrals, from a list; a
/// single number applies to all.
/// @throws UsageError  naming --Q, its value and what was expected.
[[nodiscard]] Eigen::VectorXd state_weights(const std::string& list,
                                            const std::vector<std::string>& states,
                                            const std::vector<std::string>& integrals);

/// The diagonal of the weights of the inputs, from a list; a single number applies to all.
/// @param option  e.g. "--R"
[[nodiscard]] Eigen::VectorXd input_weights(const std::string& list,
                                            const std::vector<std::string>& inputs,
                                            const std::string& option);

/// The problem for a model with these states and inputs.
/// @throws UsageError  naming the option, its value and what was expected.
[[nodiscard]] LqrDesign make_design(const LqrArguments& arguments,
                                    const std::vector<Signal>& states,
                                    const std::vector<Signal>& inputs);

}  // namespace quadtune::cli
