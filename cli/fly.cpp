// SPDX-License-Identifier: Apache-2.0
/// quadtune fly: one mission in the nonlinear simulation.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "arguments/flight_arguments.hpp"
#include "arguments/flight_outputs.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/verify/changed_export.hpp"
#include "report/flights/flights.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  FlightOptions flight;
  FlightOutputs outputs;
  std::uint64_t seeds = 1;
  bool compiled = false, arm = false;

  [[nodiscard]] FlightCodeTarget target() const {
    return arm ? FlightCodeTarget::arm : FlightCodeTarget::host;
  }
};

/// Two outputs with the same file would overwrite each other.
void refuse_one_file(const std::vector<std::pair<std::string, std::string>>& outputs) {
  const auto path = [](const std::string& file) {
    return std::filesystem::absolute(file).lexically_normal();
  };
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[i].second.empty() && !outputs[j].second.empty() &&
          path(outputs[i].second) == path(outputs[j].second))
        refuse(outputs[i].first, "{} and {} are both '{}', expected two files", outputs[j].first,
               outputs[i].first, outputs[i].second);
}

void require_sane(const Options& options, const Context& context) {
  constexpr std::uint64_t kMaxSeeds = 1000;
  const auto& [log, report] = options.outputs;
  require_output_names(options.outputs);
  refuse_one_file({{"--log", log}, {"--report", report}, {"-o", context.file}});
  if (options.seeds > kMaxSeeds)
    refuse("--seeds", "--seeds is {}, expected at most {}; use `quadtune campaign` for more",
           options.seeds, kMaxSeeds);
  if (options.arm && !options.compiled) refuse("--arm", "--arm requires --compiled");
  if (options.compiled && options.flight.gains.empty())
    refuse("--compiled", "--compiled requires --gains DIR, an export of flight code");
  std::error_code ignored;
  const std::filesystem::path code = options.flight.gains;
  if (options.compiled && !std::filesystem::exists(code / kFlightCodeName, ignored))
    refuse("--gains",
           "--gains {} has no {}, expected an export of flight code with --compiled; `quadtune "
           "export SOURCE --to c -o DIR` writes one",
           options.flight.gains, kFlightCodeName);
  if (options.seeds == 1 || (log.empty() && report.empty())) return;
  const std::string name = log.empty() ? "--report" : "--log";
  refuse(name, "{} cannot be combined with --seeds {} because it records one flight; use --seed",
         name, options.seeds);
}

/// The flights of all seeds, with the law of the library or with the program of an export.
std::vector<FlownFlight> flown(const Options& options, const PlannedFlight& plan) {
  const auto seeds = static_cast<std::uint32_t>(options.seeds);
  if (options.compiled)
    return fly_compiled(plan, options.flight.gains, options.target(), seeds, interrupted);
  if (seeds > 1) return fly_seeds(plan, seeds, interrupted);
  std::vector<FlownFlight> one;
  one.push_back(fly_planned(plan, interrupted));
  return one;
}

void tell_many(const std::vector<FlownFlight>& flights, Context& context) {
  const auto failed = std::find_if(flights.begin(), flights.end(),
                                   [](const FlownFlight& flight) { return !flight.passed; });
  std::optional<Diagnosis> diagnosis;
  if (failed != flights.end()) diagnosis = diagnose(failed->plan, *failed);
  context.print([&] { return to_json(flights, diagnosis); },
                [&] { return to_text(flights, diagnosis); });
  if (failed != flights.end())
    throw AnswerIsNo(fmt::format("seed {}: {}", failed->plan.setup.seed, reasons(*failed).front()));
}

void run_fly(Options& options, Context& context) {
  require_sane(options, context);
  options.flight.seed = context.seed;
  if (options.compiled) take_program(options.flight);
  if (options.flight.vehicle.empty()) refuse("V", "expected a vehicle");
  PlannedFlight plan = plan_flight(options.flight, context.verb);
  keep_log_for(options.outputs, plan);
  if (options.compiled && options.flight.estimator == "truth")
    plan.notes.emplace_back("the program has no estimator and is given the true state");
  context.notes("note: ", plan.notes);
  for (const std::string& changed : {changed_export(options.flight.gains),
                                     changed_vehicle(options.flight.gains, plan.setup.vehicle)})
    if (!changed.empty()) context.note("note: " + changed);
  if (options.seeds > 1) {
    tell_many(flown(options, plan), context);
    return;
  }
  const FlownFlight flight = std::move(flown(options, plan).front());
  std::optional<Diagnosis> diagnosis;
  if (!flight.passed) diagnosis = diagnose(plan, flight);
  tell_flight(flight, diagnosis, options.outputs, context);
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.flight.vehicle, "a built-in vehicle or a vehicle file");
  add_flight_options(line, options.flight);
  line.add_count(
      "--seeds N", options.seeds, 1,
      "number of flights, with the seeds --seed, --seed + 1, ...; pass if all pass; default 1");
  line.add_flag("--compiled", options.compiled,
                "compile the flight code of --gains DIR and fly its program");
  line.add_flag("--arm", options.arm, "with --compiled: compile for ARM and run under qemu-arm");
  add_flight_outputs(line, options.outputs);
}

}  // namespace

Verb fly_verb() {
  return {"fly", "V [--mission NAME|FILE] [options]",
          "fly one mission in the nonlinear simulation, with a verdict",
          "quadtune fly mambo --mission hover --report out/hover.html",
          with_options(add_options, run_fly)};
}

}  // namespace quadtune::cli
