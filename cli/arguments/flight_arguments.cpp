// SPDX-License-Identifier: Apache-2.0
#include "arguments/flight_arguments.hpp"

#include "program/command_line.hpp"
#include "program/refusal.hpp"

namespace quadtune::cli {

void add_flight_options(CommandLine& line, FlightOptions& options) {
  line.add_option("--mission NAME", options.mission,
                  "a built-in mission or a mission file (docs/formats.md); default hover");
  line.add_option("--controller KIND", options.controller,
                  "cascaded-pid (or pid), state-feedback (or lqr), or firmware, the loops of an "
                  "autopilot; default: the law of --gains, or cascaded-pid");
  line.add_option("--gains WHICH", options.gains,
                  "designed (default), published, a design file, an export, a gain schedule, or "
                  "the JSON output of a command");
  line.add_option("--integrator NAME", options.integrator,
                  "integrator of the PID: euler (default), backward-euler or tustin");
  line.add_option("--estimator NAME", options.estimator,
                  "mambo, mambo-original, mambo-raw, uquad, general or truth; default: that of the "
                  "gains file, or else one that the sensors allow");
  line.add_option("--flow MODEL", options.flow, "optical flow: full (default), simplified or off");
  line.add_positive("--flow-rate HZ", options.flow_rate,
                    "rate of the optical flow [Hz]; default: that of the vehicle");
  line.add_option("--sensors KIND", options.sensors,
                  "ideal, or real (default): the sensors of the vehicle file");
  line.add_option("--wind WIND", options.wind,
                  "calm (default), light, moderate, severe, or a list: north=3,gust_east=2");
  line.add_option(
      "--allocation RULE", options.allocation,
      "allocation of commands beyond the limits of the motors: prioritized (default) or clipped");
  line.add_option("--take-off HOW", options.take_off,
                  "climb: under the control law; thrust: a second of constant thrust; default: "
                  "that of the mission");
  line.add_positive("--duration S", options.duration,
                    "duration of the flight [s]; default: that of the mission");
  line.add_option("--solver NAME", options.solver,
                  "euler, bogacki-shampine-3 (default) or runge-kutta-4");
  line.add_positive("--step S", options.step, "maximum step of the solver [s]; default 0.005");
  line.add_flag("--dynamic-environment", options.dynamic_environment,
                "air density, gravity and magnetic field vary with height");
}

}  // namespace quadtune::cli
