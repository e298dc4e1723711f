// SPDX-License-Identifier: Apache-2.0
#include "arguments/flight_outputs.hpp"

#include "arguments/flight_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "report/flights/flights.hpp"

namespace quadtune::cli {

void add_flight_outputs(CommandLine& line, FlightOutputs& outputs) {
  line.add_option("--log FILE", outputs.log, "write every control period to a .csv or .mat file");
  line.add_option("--report FILE", outputs.report, "write a web page: a .html file");
}

void require_output_names(const FlightOutputs& outputs) {
  if (!outputs.report.empty() && !outputs.report.ends_with(".html"))
    refuse("--report", "--report is '{}', expected a name that ends in .html", outputs.report);
  if (!outputs.log.empty() && !outputs.log.ends_with(".csv") && !outputs.log.ends_with(".mat"))
    refuse("--log", "--log is '{}', expected a name that ends in .csv or .mat", outputs.log);
}

void keep_log_for(const FlightOutputs& outputs, PlannedFlight& plan) {
  if (!outputs.log.empty() || !outputs.report.empty()) keep_log(plan);
}

void tell_flight(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis,
                 const FlightOutputs& outputs, Context& context) {
  if (!outputs.log.empty()) context.write(outputs.log, log_bytes(flight.result.log, outputs.log));
  if (!outputs.report.empty())
    context.write(outputs.report, html(flight_page(flight, context.command, diagnosis)));
  context.print([&] { return to_json(flight, diagnosis); },
                [&] { return to_text(flight, diagnosis); });
  if (!flight.passed) throw AnswerIsNo(reasons(flight).front());
}

}  // namespace quadtune::cli
