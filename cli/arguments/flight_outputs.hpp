// SPDX-License-Identifier: Apache-2.0
/// The outputs of one flight: the files of --log and --report, and the printed text.
#pragma once

#include <optional>
#include <string>

#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune::cli {

class CommandLine;
struct Context;

struct FlightOutputs {
  std::string log, report;  ///< file names; empty if not requested
};

/// Adds --log and --report.
void add_flight_outputs(CommandLine& line, FlightOutputs& outputs);

/// @throws UsageError  if the extension of a name does not match its format
void require_output_names(const FlightOutputs& outputs);

/// Enables logging of every control period if one of the files needs it.
/// @throws UsageError  if the log would not fit into memory
void keep_log_for(const FlightOutputs& outputs, PlannedFlight& plan);

/// Writes the files and prints the flight.
/// @param diagnosis  of a flight that failed, if one was computed
/// @throws AnswerIsNo  if the flight failed
/// @throws FileError, Interrupted
void tell_flight(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis,
                 const FlightOutputs& outputs, Context& context);

}  // namespace quadtune::cli
