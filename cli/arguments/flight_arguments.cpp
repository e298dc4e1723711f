// SPDX-License-Identifier: Apache-2.0
#include "arguments/flight_arguments.hpp"

#include "program/command_line.hpp"

namespace quadtune::cli {

void add_flight_options(CommandLine& line, FlightOptions& options) {
  line.add_option("--mission", options.mission,
                  "a built-in mission or a mission file (docs/formats.md); hover")
      ->type_name("NAME");
  line.add_option(
          "--controller", options.controller,
          "cascaded-pid (or pid), state-feedback (or lqr); what --gains holds, or cascaded-pid")
      ->type_name("KIND");
  line.add_option("--gains", options.gains,
                  "designed (default), published, a design file, an export, a gain schedule, or "
                  "what lqr or pid wrote as JSON")
      ->type_name("WHICH");
  line.add_option("--integrator", options.integrator,
                  "of the PID: euler (default), backward-euler or tustin")
      ->type_name("NAME");
  line.add_option("--estimator", options.estimator,
                  "mambo, mambo-original, mambo-raw, uquad, general or truth; default: that of the "
                  "gains file, else what the sensors allow")
      ->type_name("NAME");
  line.add_option("--flow", options.flow, "optical flow: full (default), simplified or off")
      ->type_name("MODEL");
  line.add_positive("--flow-rate", options.flow_rate, "of the optical flow [Hz]; the vehicle's")
      ->type_name("HZ");
  line.add_option("--sensors", options.sensors, "ideal, or real (default): as the vehicle's are")
      ->type_name("KIND");
  line.add_option("--wind", options.wind,
                  "calm (default), light, moderate, severe, or a list: north=3,gust_east=2")
      ->type_name("WIND");
  line.add_option("--allocation", options.allocation,
                  "of commands beyond the motors' limits: prioritized (default) or clipped")
      ->type_name("RULE");
  line.add_option("--take-off", options.take_off,
                  "climb: under the control law; thrust: a second of constant thrust; default: the "
                  "mission's")
      ->type_name("HOW");
  line.add_positive("--duration", options.duration, "[s]; the mission's")->type_name("S");
  line.add_option("--solver", options.solver,
                  "euler, bogacki-shampine-3 (default) or runge-kutta-4")
      ->type_name("NAME");
  line.add_positive("--step", options.step, "longest step of the solver [s]; 0.005")
      ->type_name("S");
  line.add_flag("--dynamic-environment", options.dynamic_environment,
                "air, gravity and magnetic field change with height");
}

PlannedFlight plan_of_command(const FlightOptions& options, const std::string& verb) {
  if (options.vehicle.empty())
    throw UsageError(fmt::format("quadtune {}: expected a vehicle", verb), "V");
  return option_of_command(verb, [&] { return plan_flight(options, verb); });
}

}  // namespace quadtune::cli
