// SPDX-License-Identifier: Apache-2.0
/// The linear model that arguments ask for, as `quadtune linearize` takes its options.
#pragma once

#include <string>

#include "arguments.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

namespace quadtune::python {

struct PlantWords {
  std::string vehicle;
  std::string at = "hover";
  double speed = 0, climb = 0, radius = 0, yaw_rate = 0, yaw = 0;
  std::string convention = "ned", inputs = "rotor-speed", states = "full";
};

/// Trims and linearizes.
/// @throws InvalidInput, FileError, NoSolution
[[nodiscard]] LinearVehicle make_plant(const PlantWords& words);

}  // namespace quadtune::python
