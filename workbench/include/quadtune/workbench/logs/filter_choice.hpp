// SPDX-License-Identifier: Apache-2.0
/// A filter model with some of its numbers chosen before it is tuned.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

struct FilterChoice {
  std::vector<std::string> fixed;                      ///< parameters that stay as they are
  std::vector<std::pair<std::string, double>> starts;  ///< parameters, and where the search begins
  double gate = 0;     ///< of all sensors, > 0 [variances]; 0: as the model has it
  double student = 0;  ///< degrees of freedom of all sensors, > 2; 0: as the model has it
};

/// @throws InvalidInput  "--fix", "--start" or "--gate, --student": for a parameter that the model
///                       does not have, and a number out of range
[[nodiscard]] FilterModel chosen_filter(FilterModel model, const FilterChoice& choice);

}  // namespace quadtune
