// SPDX-License-Identifier: Apache-2.0
/// On which plant `lqr V` designs, as --plant, --structure and the other options say.
#pragma once

#include <string>

#include "arguments/flown_lqr_arguments.hpp"

namespace quadtune::cli {

class CommandLine;

struct PlantChoice {
  bool flown = true;       // with the rotors' lag, the sensors' delays and the estimator
  bool matrix = false;     // --structure matrix
  std::string implied_by;  // the option of the ideal plant that decided, where --plant is silent
};

/// @param line       after parse()
/// @param plant      "flown", "ideal"; empty: by the other options
/// @param structure  "dynamic", "matrix"; empty: dynamic
/// @param flown      with the options of the flown plant that came
/// @throws UsageError  for other words, and for options of the other plant or structure
[[nodiscard]] PlantChoice choose_plant(const CommandLine& line, const std::string& plant,
                                       const std::string& structure,
                                       const FlownLqrArguments& flown);

}  // namespace quadtune::cli
