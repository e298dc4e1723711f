// SPDX-License-Identifier: Apache-2.0
/// quadtune fly: one mission in the nonlinear simulation.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "arguments/flight_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "report/flights/flight_story.hpp"

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

constexpr std::uint64_t kMostSeeds = 1000;

/// Several seeds: one verdict, a table, and why the first that failed did.
void fly_many(const PlannedFlight& plan, std::uint32_t seeds, Context& context) {
  const std::vector<FlownFlight> flights = fly_seeds(plan, seeds, interrupted);
  const auto failed = std::find_if(flights.begin(), flights.end(),
                                   [](const FlownFlight& flight) { return !flight.passed; });
  std::optional<Diagnosis> diagnosis;
  if (failed != flights.end()) diagnosis = diagnose(failed->plan, *failed);
  if (context.json) {
    internal::Json json = internal::Json::array();
    for (const FlownFlight& flight : flights) {
      const bool first = failed != flights.end() && &flight == &*failed;
      json.push_back(to_json(flight, first ? diagnosis : std::nullopt));
    }
    context.out << internal::readable(json) << "\n";
  } else {
    const FlownFlight worst = worst_of(flights);
    const auto passed = std::count_if(flights.begin(), flights.end(),
                                      [](const FlownFlight& flight) { return flight.passed; });
    context.out << fmt::format("verdict of {} seeds: {}, {} passed\n", seeds,
                               worst.passed ? "pass" : "fail", passed)
                << seeds_table(worst.seeds)
                << fmt::format("\n{}, seed {}\n",
                               worst.passed ? "the first" : "the first that failed",
                               worst.plan.setup.seed)
                << to_text(worst, diagnosis);
  }
  if (failed != flights.end())
    throw AnswerIsNo(
        fmt::format("fly: seed {}: {}", failed->plan.setup.seed, reasons(*failed).front()));
}

}  // namespace

Verb fly_verb() {
  struct Options {
    FlightOptions flight;
    std::string log, report;
    std::uint64_t seeds = 1;
  };
  return {"fly", "V [--mission NAME|FILE] [options]",
          "fly one mission in the nonlinear simulation, with a verdict",
          "quadtune fly mambo --mission hover --report out/hover.html",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("V", options->flight.vehicle, "a built-in vehicle or a vehicle file");
            add_flight_options(line, options->flight);
            line.add_count("--seeds", options->seeds, 1,
                           "flights with the seeds --seed, --seed + 1, ...; pass if all pass; 1")
                ->type_name("N");
            line.add_option("--log", options->log, "write every period to a .csv or .mat file")
                ->type_name("FILE");
            line.add_option("--report", options->report, "write a page to look at: a .html file")
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
              if (options->seeds > kMostSeeds)
                throw UsageError(fmt::format("quadtune fly: --seeds is {}, expected at most {}; "
                                             "quadtune campaign flies more",
                                             options->seeds, kMostSeeds),
                                 "--seeds");
              for (const auto& [name, file] :
                   {std::pair("--log", &options->log), std::pair("--report", &options->report)})
                if (options->seeds > 1 && !file->empty())
                  throw UsageError(
                      fmt::format("quadtune fly: {} cannot be combined with --seeds {} "
                                  "because it records one flight; use --seed",
                                  name, options->seeds),
                      name);
              options->flight.seed = context.seed;
              PlannedFlight plan = plan_of_command(options->flight, "fly");
              if (!options->log.empty() || !options->report.empty())
                option_of_command("fly", [&] { keep_log(plan); });
              for (const std::string& note : plan.notes) context.note("fly: note: " + note);
              if (options->seeds > 1) {
                fly_many(plan, static_cast<std::uint32_t>(options->seeds), context);
                return;
              }
              const FlownFlight flight = fly_planned(plan, interrupted);
              std::optional<Diagnosis> diagnosis;
              if (!flight.passed) diagnosis = diagnose(plan, flight);
              if (!options->log.empty()) {
                write_file(options->log, log_bytes(flight.result.log, options->log));
                context.written.push_back(options->log);
              }
              if (!options->report.empty()) {
                write_file(options->report, html(report_of(flight, context.command, diagnosis)));
                context.written.push_back(options->report);
              }
              if (context.json)
                context.out << internal::readable(to_json(flight, diagnosis)) << "\n";
              else
                context.out << to_text(flight, diagnosis);
              if (!flight.passed) throw AnswerIsNo("fly: " + reasons(flight).front());
            };
          }};
}

}  // namespace quadtune::cli
