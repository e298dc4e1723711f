// SPDX-License-Identifier: Apache-2.0
/// quadtune lqg: state feedback and filter together, with the deviations that sensor noise causes.
#include "arguments/flown_lqr_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"
#include "report/gains/gains.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  LqrArguments common;
  FlownLqrArguments flown;
  LqgOptions lqg;
};

void run_lqg(const CommandLine& line, const Options& options, Context& context) {
  if (!options.lqg.recover && line.was_given("--noise-budget"))
    refuse("lqg", "--noise-budget", "--noise-budget requires --recover");
  if (options.common.plant.vehicle.empty())
    refuse("lqg", "V", "expected a built-in vehicle or a vehicle file");
  require_positive(options.lqg.time, "lqg", "--time");
  constexpr double kMax = 1e6;
  if (options.lqg.time > kMax)
    refuse("lqg", "--time", "--time is {}, expected at most {} s", number(options.lqg.time),
           number(kMax));
  const Vehicle vehicle = load_vehicle(options.common.plant.vehicle);
  const LqgReport report = design_on_flown_plant(
      options.common, options.flown, [&](const FlightOptions& flight, const FlownLoopOptions& at) {
        LqgOptions asked = options.lqg;
        asked.design = flown_lqi_options(vehicle, lqi_design(options.common, options.flown));
        return lqg_report(vehicle, asked, flight, at);
      });
  context.notes("lqg: ", report.messages);
  context.print([&] { return to_json(report, vehicle); }, [&] { return to_text(report); });
}

void add_options(CommandLine& line, Options& options) {
  options.common.verb = "lqg";
  line.add_option("V", options.common.plant.vehicle, "built-in vehicle or vehicle file");
  line.add_option("--Q FILE|LIST", options.common.Q,
                  "weights of the 12 states, then of the integrals; a single number applies to "
                  "all; default: Bryson's rule, relaxed until the margins are met");
  line.add_option("--R FILE|LIST", options.common.R, "weights of the wrench, likewise");
  line.add_option("--integral LIST", options.common.integral,
                  "states to integrate, or none; default px,py,pz,yaw");
  line.add_number("--dt T", options.common.dt, "control period [s], default 0.005");
  add_flown_lqr_options(line, options.flown);
  line.add_number("--time S", options.lqg.time, "time of the prediction [s], default 60");
  line.add_flag("--recover", options.lqg.recover,
                "raise the gyroscope and accelerometer noise that the filter assumes if that gives "
                "larger margins (loop transfer recovery)");
  line.add_number(
      "--noise-budget F", options.lqg.noise_budget,
      "largest factor by which --recover may increase the rms of a command, default 1.5");
}

}  // namespace

Verb lqg_verb() {
  return {"lqg", "V [options]",
          "state feedback and filter of a vehicle: predicted deviations, margins with the filter",
          "quadtune lqg mambo --recover", with_options(add_options, run_lqg)};
}

}  // namespace quadtune::cli
