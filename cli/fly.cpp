// SPDX-License-Identifier: Apache-2.0
/// quadtune fly: one mission in the nonlinear simulation.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <ostream>

#include "flight_arguments.hpp"
#include "flight_story.hpp"
#include "program.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune::cli {
namespace {

/// Two outputs into one file would leave the second.
void refuse_one_file(const std::vector<std::pair<std::string, std::string>>& outputs) {
  const auto path = [](const std::string& file) {
    return std::filesystem::absolute(file).lexically_normal();
  };
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[i].second.empty() && !outputs[j].second.empty() &&
          path(outputs[i].second) == path(outputs[j].second))
        throw UsageError(fmt::format("quadtune fly: {} and {} are both '{}', expected two files",
                                     outputs[j].first, outputs[i].first, outputs[i].second),
                         outputs[i].first);
}

}  // namespace

Verb fly_verb() {
  struct Options {
    FlightOptions flight;
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
              refuse_one_file(
                  {{"--log", options->log}, {"--report", options->report}, {"-o", context.file}});
              options->flight.seed = context.seed;
              PlannedFlight plan = plan_of_command(options->flight, "fly");
              if (!options->log.empty() || !options->report.empty())
                told_of_command("fly", [&] { keep_log(plan); });
              for (const std::string& note : plan.notes) context.note("fly: note: " + note);
              const FlownFlight flight = fly_planned(std::move(plan), interrupted);
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
