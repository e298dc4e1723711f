// SPDX-License-Identifier: Apache-2.0
#include "arguments/flight_outputs.hpp"

#include <fmt/format.h>

#include "arguments/flight_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "report/flights/flight_page.hpp"
#include "report/flights/flight_text.hpp"

namespace quadtune::cli {
namespace {

[[noreturn]] void refuse_name(const std::string& verb, const std::string& option,
                              const std::string& name, const char* endings) {
  throw UsageError(fmt::format("quadtune {}: {} is '{}', expected a name that ends in {}", verb,
                               option, name, endings),
                   option);
}

}  // namespace

void add_flight_outputs(CommandLine& line, FlightOutputs& outputs) {
  line.add_option("--log", outputs.log, "write every period to a .csv or .mat file")
      ->type_name("FILE");
  line.add_option("--report", outputs.report, "write a page to look at: a .html file")
      ->type_name("FILE");
}

void require_output_names(const FlightOutputs& outputs, const std::string& verb) {
  if (!outputs.report.empty() && !outputs.report.ends_with(".html"))
    refuse_name(verb, "--report", outputs.report, ".html");
  if (!outputs.log.empty() && !outputs.log.ends_with(".csv") && !outputs.log.ends_with(".mat"))
    refuse_name(verb, "--log", outputs.log, ".csv or .mat");
}

void keep_log_for(const FlightOutputs& outputs, PlannedFlight& plan, const std::string& verb) {
  if (!outputs.log.empty() || !outputs.report.empty())
    option_of_command(verb, [&] { keep_log(plan); });
}

void tell_flight(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis,
                 const FlightOutputs& outputs, const std::string& verb, Context& context) {
  if (!outputs.log.empty()) {
    write_file(outputs.log, log_bytes(flight.result.log, outputs.log));
    context.written.push_back(outputs.log);
  }
  if (!outputs.report.empty()) {
    write_file(outputs.report, html(flight_page(flight, context.command, diagnosis)));
    context.written.push_back(outputs.report);
  }
  context.print([&] { return to_json(flight, diagnosis); },
                [&] { return to_text(flight, diagnosis); });
  if (!flight.passed) throw AnswerIsNo(verb + ": " + reasons(flight).front());
}

}  // namespace quadtune::cli
