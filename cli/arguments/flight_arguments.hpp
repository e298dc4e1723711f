// SPDX-License-Identifier: Apache-2.0
/// Options that select a flight, for `fly`, `compare` and other commands that fly.
#pragma once

#include <string>

#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune::cli {

class CommandLine;

/// Adds V and all options of FlightOptions except --seed, which every command has.
void add_flight_options(CommandLine& line, FlightOptions& options);

}  // namespace quadtune::cli
