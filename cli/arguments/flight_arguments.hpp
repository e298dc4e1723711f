// SPDX-License-Identifier: Apache-2.0
/// Options that say what is flown, for `fly`, `compare` and those that fly; and whose mistake a
/// word is that they do not know: the command line's or a file's.
#pragma once

#include <string>

#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune::cli {

class CommandLine;

/// Adds V and all of these but --seed, which every verb has.
void add_flight_options(CommandLine& line, FlightOptions& options);

/// Runs a function whose options came from the command line.
/// @throws UsageError  in place of OptionError
template <class Function>
auto option_of_command(const std::string& verb, Function&& function) {
  try {
    return function();
  } catch (const OptionError& error) {
    refuse(verb, "--" + error.option(), "--{}", error.what());
  }
}

/// The same; a control period of --dt may be too short for the estimator.
/// @param has_dt  whether --dt came
template <class Function>
auto period_of_command(const std::string& verb, bool has_dt, Function&& function) {
  try {
    return option_of_command(verb, function);
  } catch (const InvalidInput& error) {
    if (!has_dt || error.where() != "estimator general") throw;
    refuse(verb, "--dt", "--dt: {}", error.what());
  }
}

/// The flight that a command line asks for.
/// @param verb  for messages
/// @throws UsageError, InvalidInput, FileError, NoSolution
[[nodiscard]] PlannedFlight plan_of_command(const FlightOptions& options, const std::string& verb);

}  // namespace quadtune::cli
