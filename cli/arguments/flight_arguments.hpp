// SPDX-License-Identifier: Apache-2.0
/// Options that select a flight, for `fly`, `compare` and other commands that fly; and the
/// functions that turn errors of the libraries into errors of the option that caused them.
#pragma once

#include <string>

#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune::cli {

class CommandLine;

/// Adds V and all options of FlightOptions except --seed, which every command has.
void add_flight_options(CommandLine& line, FlightOptions& options);

/// Calls a function whose options were given on the command line.
/// @throws UsageError  in place of OptionError
template <class Function>
auto option_of_command(const std::string& verb, Function&& function) {
  try {
    return function();
  } catch (const OptionError& error) {
    refuse(verb, "--" + error.option(), "--{}", error.what());
  }
}

/// As option_of_command(). If the control period of --dt is too short for the estimator, the error
/// names --dt.
/// @param has_dt  whether --dt was given
template <class Function>
auto period_of_command(const std::string& verb, bool has_dt, Function&& function) {
  try {
    return option_of_command(verb, function);
  } catch (const InvalidInput& error) {
    if (!has_dt || error.where() != "estimator general") throw;
    refuse(verb, "--dt", "--dt: {}", error.what());
  }
}

/// The flight that the options of a command line describe.
/// @param verb  name of the command, for messages
/// @throws UsageError, InvalidInput, FileError, NoSolution
[[nodiscard]] PlannedFlight plan_of_command(const FlightOptions& options, const std::string& verb);

}  // namespace quadtune::cli
