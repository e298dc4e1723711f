// SPDX-License-Identifier: Apache-2.0
#include "flight_arguments.hpp"

#include <CLI/CLI.hpp>

#include "number_arguments.hpp"

namespace quadtune::cli {

void add_flight_options(CLI::App& app, FlightOptions& options) {
  app.add_option("--mission", options.mission,
                 "a built-in mission or a mission file (docs/formats.md); hover")
      ->type_name("NAME");
  app.add_option(
         "--controller", options.controller,
         "cascaded-pid (or pid), state-feedback (or lqr); what --gains holds, or cascaded-pid")
      ->type_name("KIND");
  app.add_option("--gains", options.gains,
                 "designed (default), published, a design file, an export, a gain schedule, or "
                 "what lqr or pid wrote as JSON")
      ->type_name("WHICH");
  app.add_option("--integrator", options.integrator,
                 "of the PID: euler (default), backward-euler or tustin")
      ->type_name("NAME");
  app.add_option("--estimator", options.estimator,
                 "mambo, mambo-original, mambo-raw, uquad, general or truth; default: that of the "
                 "gains file, else what the sensors allow")
      ->type_name("NAME");
  app.add_option("--flow", options.flow, "optical flow: full (default), simplified or off")
      ->type_name("MODEL");
  add_positive(app, "--flow-rate", options.flow_rate, "of the optical flow [Hz]; the vehicle's")
      ->type_name("HZ");
  app.add_option("--sensors", options.sensors, "ideal, or real (default): as the vehicle's are")
      ->type_name("KIND");
  app.add_option("--wind", options.wind,
                 "calm (default), light, moderate, severe, or a list: north=3,gust_east=2")
      ->type_name("WIND");
  app.add_option("--allocation", options.allocation,
                 "of commands beyond the motors' limits: prioritized (default) or clipped")
      ->type_name("RULE");
  app.add_option("--take-off", options.take_off,
                 "climb: under the control law; thrust: a second of constant thrust; default: the "
                 "mission's")
      ->type_name("HOW");
  add_positive(app, "--duration", options.duration, "[s]; the mission's")->type_name("S");
  app.add_option("--solver", options.solver, "euler, bogacki-shampine-3 (default) or runge-kutta-4")
      ->type_name("NAME");
  add_positive(app, "--step", options.step, "longest step of the solver [s]; 0.005")
      ->type_name("S");
  app.add_flag("--dynamic-environment", options.dynamic_environment,
               "air, gravity and magnetic field change with height");
}

PlannedFlight plan_of_command(const FlightOptions& options, const std::string& verb) {
  if (options.vehicle.empty())
    throw UsageError(fmt::format("quadtune {}: expected a vehicle", verb), "V");
  return told_of_command(verb, [&] { return plan_flight(options, verb); });
}

}  // namespace quadtune::cli
