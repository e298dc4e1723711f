// SPDX-License-Identifier: Apache-2.0
#include "arguments/flown_or_ideal.hpp"

#include "arguments/flight_arguments.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"

namespace quadtune::cli {

bool asks_for_flown_plant(const std::string& plant, const std::string& verb) {
  return option_of_command(verb, [&] { return quadtune::asks_for_flown_plant(plant); });
}

}  // namespace quadtune::cli
