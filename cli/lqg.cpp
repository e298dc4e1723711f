// SPDX-License-Identifier: Apache-2.0
/// quadtune lqg: state feedback and filter together, with what the sensors' noise makes of them.
#include <fmt/format.h>

#include <memory>

#include "arguments/flown_lqr_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"
#include "report/gains/lqg_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  LqrArguments common;
  FlownLqrArguments flown;
  double time = LqgOptions().time;
  bool recover = false;
  double noise_budget = LqgOptions().noise_budget;
};

void run(const Options& options, Context& context) {
  if (options.common.plant.vehicle.empty())
    throw UsageError("quadtune lqg: expected a vehicle, built in or a file", "V");
  require_positive(options.time, "lqg", "--time");
  constexpr double kLongest = 1e6;
  if (options.time > kLongest)
    throw UsageError(fmt::format("quadtune lqg: --time is {}, expected at most {} s",
                                 number(options.time), number(kLongest)),
                     "--time");
  const Vehicle vehicle = load_vehicle(options.common.plant.vehicle);
  const LqgReport report = design_on_flown_plant(
      options.common, options.flown, [&](const FlightOptions& flight, const FlownLoopOptions& at) {
        LqgOptions asked;
        asked.design = flown_lqi_options(vehicle, lqi_design(options.common, options.flown));
        asked.time = options.time;
        asked.recover = options.recover;
        asked.noise_budget = options.noise_budget;
        return lqg_report(vehicle, asked, flight, at);
      });
  for (const std::string& message : report.messages) context.note("lqg: " + message);
  context.print([&] { return to_json(report, vehicle); }, [&] { return to_text(report); });
}

}  // namespace

Verb lqg_verb() {
  return {
      "lqg", "V [options]",
      "state feedback and filter of a vehicle: predicted deviations, margins with the filter",
      "quadtune lqg mambo --recover", [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        options->common.verb = "lqg";
        line.add_option("V", options->common.plant.vehicle, "built-in vehicle or vehicle file");
        line.add_option("--Q", options->common.Q,
                        "weights of the 12 states, then of the integrals; one number stands for "
                        "all; default: Bryson's rule, softened until the margins are met")
            ->type_name("FILE|LIST");
        line.add_option("--R", options->common.R, "weights of the wrench, likewise")
            ->type_name("FILE|LIST");
        line.add_option("--integral", options->common.integral,
                        "states to integrate, or none; default px,py,pz,yaw")
            ->type_name("LIST");
        line.add_number("--dt", options->common.dt, "control period [s], default 0.005")
            ->type_name("T");
        add_flown_lqr_options(line, options->flown);
        line.add_number("--time", options->time, "time of the prediction [s], default 60")
            ->type_name("S");
        line.add_flag("--recover", options->recover,
                      "raise the noise that the filter assumes of gyroscope and accelerometer "
                      "where that gives larger margins (loop transfer recovery)");
        line.add_number("--noise-budget", options->noise_budget,
                        "most by which --recover may multiply the rms of a command, default 1.5")
            ->type_name("F");
        return [options, owner = &line](Context& context) {
          options->common.has_dt = owner->was_given("--dt");
          options->flown.given = given_flown_options(*owner);
          if (!options->recover && owner->was_given("--noise-budget"))
            throw UsageError(
                "quadtune lqg: --noise-budget came without --recover, expected "
                "both",
                "--noise-budget");
          run(*options, context);
        };
      }};
}

}  // namespace quadtune::cli
