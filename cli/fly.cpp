// SPDX-License-Identifier: Apache-2.0
/// quadtune fly: one mission in the nonlinear simulation.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "flight_arguments.hpp"
#include "flight_story.hpp"
#include "program.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune::cli {

Verb fly_verb() {
  struct Options {
    FlightArguments flight;
    std::string log, report;
  };
  return {"fly", "V [--mission NAME|FILE] [options]",
          "fly one mission in the nonlinear simulation, with a verdict",
          "quadtune fly mambo --mission hover --report out/hover.html",
          [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("V", options->flight.vehicle, "a built-in vehicle or a vehicle file");
            add_flight_options(app, options->flight);
            app.add_option("--log", options->log, "write every period to a .csv or .mat file")
                ->type_name("FILE");
            app.add_option("--report", options->report, "write a page to look at: a .html file")
                ->type_name("FILE");
            return [options](Context& context) {
              if (!options->report.empty() && !options->report.ends_with(".html"))
                throw UsageError(fmt::format("quadtune fly: --report is '{}', expected a name that "
                                             "ends in .html",
                                             options->report),
                                 "--report");
              if (!options->log.empty() && !options->log.ends_with(".csv") &&
                  !options->log.ends_with(".mat"))
                throw UsageError(fmt::format("quadtune fly: --log is '{}', expected a name that "
                                             "ends in .csv or .mat",
                                             options->log),
                                 "--log");
              options->flight.seed = context.seed;
              PlannedFlight plan = plan_flight(options->flight, "fly");
              plan.setup.log = !options->log.empty() || !options->report.empty();
              for (const std::string& note : plan.notes) context.note("fly: note: " + note);
              const FlownFlight flight = fly_planned(std::move(plan));
              if (!options->log.empty()) {
                write_file(options->log, log_bytes(flight.result.log, options->log));
                context.written.push_back(options->log);
              }
              if (!options->report.empty()) {
                write_file(options->report, html(report_of(flight, context.command)));
                context.written.push_back(options->report);
              }
              if (context.json)
                context.out << internal::readable(to_json(flight)) << "\n";
              else
                context.out << to_text(flight);
              if (!flight.passed) throw AnswerIsNo("fly: " + reasons(flight).front());
            };
          }};
}

}  // namespace quadtune::cli
