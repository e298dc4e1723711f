// SPDX-License-Identifier: Apache-2.0
/// What is left of one flight: --log and --report, and what is printed.
#pragma once

#include <optional>
#include <string>

#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune::cli {

class CommandLine;
struct Context;

struct FlightOutputs {
  std::string log, report;  ///< files; empty: none
};

/// Adds --log and --report.
void add_flight_outputs(CommandLine& line, FlightOutputs& outputs);

/// @param verb  for messages
/// @throws UsageError  for a name that does not end as the format does
void require_output_names(const FlightOutputs& outputs, const std::string& verb);

/// Has the flight's log kept, where one of the files needs it.
/// @throws UsageError  for a flight whose record would not fit into memory
void keep_log_for(const FlightOutputs& outputs, PlannedFlight& plan, const std::string& verb);

/// Writes the files and prints the flight.
/// @param diagnosis  of a flight that failed, if it was made
/// @throws AnswerIsNo  where the flight did not pass
/// @throws FileError, Interrupted
void tell_flight(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis,
                 const FlightOutputs& outputs, const std::string& verb, Context& context);

}  // namespace quadtune::cli
