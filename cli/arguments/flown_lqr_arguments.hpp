// SPDX-License-Identifier: Apache-2.0
/// Options of a state feedback that is designed on the flown plant: motor lag, sensor delays and
/// estimator included.
#pragma once

#include <optional>
#include <string>

#include "arguments/flight_arguments.hpp"
#include "arguments/lqr_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "quadtune/design.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune::cli {

class CommandLine;

struct FlownLqrArguments {
  std::string change;          // list: weights of the changes of the commands
  std::optional<double> past;  // control periods
  std::string estimator, sensors;
  double height = FlownLoopOptions().height;
};

/// Adds --change, --past, --estimator, --sensors and --height.
void add_flown_lqr_options(CommandLine& line, FlownLqrArguments& arguments);

/// The design that --Q, --R, --change, --integral, --past and --dt describe.
/// @throws UsageError  naming the option, its value and what was expected
[[nodiscard]] LqiDesign lqi_design(const LqrArguments& common, const FlownLqrArguments& arguments);

/// The design of a matrix on the states, in the convention of --convention and with the inputs of
/// --inputs.
/// @param asks_for_inputs  whether --inputs was given; otherwise the inputs are the wrench
[[nodiscard]] LqiDesign matrix_design(const LqrArguments& common,
                                      const FlownLqrArguments& arguments, bool asks_for_inputs);

/// Calls `design` with the hover at which the loop is analysed.
/// @throws UsageError, OptionError  for invalid options of the hover
/// @throws NoSolution  if no solution exists; it names --Q if the weights were given
template <class Function>
auto design_on_flown_plant(const LqrArguments& common, const FlownLqrArguments& arguments,
                           Function&& design) {
  require_positive(arguments.height, "--height", "metres");
  FlightOptions flight;
  flight.vehicle = common.plant.vehicle;
  flight.estimator = arguments.estimator;
  flight.sensors = arguments.sensors;
  FlownLoopOptions at;
  at.height = arguments.height;
  try {
    require_flight_words(flight);
    return design(flight, at);
  } catch (const NoSolution& error) {
    // A state is not observable through the given weights.
    if (common.Q.empty()) throw;
    throw NoSolution(error.what(), "--Q");
  }
}

}  // namespace quadtune::cli
