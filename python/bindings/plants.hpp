// SPDX-License-Identifier: Apache-2.0
/// The linear model that arguments ask for, as `quadtune linearize` takes its options, and the LQR
/// problem on it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "support/arguments.hpp"

namespace quadtune::python {

struct PlantWords {
  std::string vehicle;
  std::string at = "hover";
  double speed = 0, climb = 0, radius = 0, yaw_rate = 0, yaw = 0;
  std::string convention = "ned", inputs = "rotor-speed", states = "full";
};

/// @throws InvalidInput
[[nodiscard]] FlightCondition flight_condition(const PlantWords& words);

/// @throws InvalidInput, FileError
[[nodiscard]] LinearizeOptions linearize_options(const PlantWords& words);

/// Trims and linearizes.
/// @throws InvalidInput, FileError, NoSolution
[[nodiscard]] LinearVehicle make_plant(const PlantWords& words);

/// The LQR problem that is posed on a linear model.
struct LqrWords {
  std::optional<Numbers> Q, R;  ///< none: all weights are 1
  std::vector<std::string> integrals;
  std::string method = "continuous";
  std::optional<double> dt;  ///< [s]
};

/// The names of an argument `integral`; none for no argument and for "none".
[[nodiscard]] std::vector<std::string> listed(const std::optional<Names>& names);

/// The names of states, followed by those of their integrals.
[[nodiscard]] std::vector<std::string> with_integrals(std::vector<std::string> states,
                                                      const std::vector<std::string>& integrals);

/// @param plant           convention and inputs of the model
/// @param states, inputs  of the model
/// @throws InvalidInput
[[nodiscard]] LqrDesign lqr_design(const LqrWords& words, const PlantWords& plant,
                                   const std::vector<Signal>& states,
                                   const std::vector<Signal>& inputs);

}  // namespace quadtune::python
