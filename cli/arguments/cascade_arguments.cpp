// SPDX-License-Identifier: Apache-2.0
#include "arguments/cascade_arguments.hpp"

#include "program/command_line.hpp"

namespace quadtune::cli {

void add_cascade_options(CommandLine& line, CascadeArguments& arguments) {
  line.add_number("--dt", arguments.dt,
                  "with V: sample period [s]; that of its published gains, or 0.005")
      ->type_name("T");
  line.add_option(
          "--bandwidth", arguments.bandwidth,
          "with V: where the rate's loop crosses 1 [rad/s]: roll=40,x=2, or one number for all")
      ->type_name("LIST");
  line.add_option(
          "--sensor-delay", arguments.sensor_delay,
          "with V: how late the loops see their values [s]: one number, or roll=0.005,x=0.02")
      ->type_name("LIST");
  line.add_number("--motor-lag", arguments.motor_lag,
                  "with V: time constant of the motors [s]; the vehicle's")
      ->type_name("S");
  line.add_number("--tracking-max", arguments.tracking_max,
                  "with V: max |value / set point| up to this; 1.3")
      ->type_name("M");
  line.add_option("--integral", arguments.integral,
                  "with V: loops that have an integral, or none; all")
      ->type_name("LIST");
  line.add_option("--integrator", arguments.integrator,
                  "with V: euler (default), backward-euler or tustin")
      ->type_name("NAME");
  line.add_flag(
      "--free", arguments.free,
      "with V: do not hold the loops to the Ms, noise and load peak of the published gains");
}

const std::vector<std::string>& cascade_option_names() {
  static const std::vector<std::string> names = {"--dt",         "--bandwidth",    "--sensor-delay",
                                                 "--motor-lag",  "--tracking-max", "--integral",
                                                 "--integrator", "--free"};
  return names;
}

CascadeOptions given_cascade_options(const CommandLine& line, const CascadeArguments& arguments) {
  CascadeOptions options;
  if (line.was_given("--dt")) options.dt = arguments.dt;
  if (line.was_given("--bandwidth")) options.bandwidth = arguments.bandwidth;
  if (line.was_given("--sensor-delay")) options.sensor_delay = arguments.sensor_delay;
  if (line.was_given("--motor-lag")) options.motor_lag = arguments.motor_lag;
  if (line.was_given("--tracking-max")) options.tracking_max = arguments.tracking_max;
  if (line.was_given("--integral")) options.integral = arguments.integral;
  if (line.was_given("--integrator")) options.integrator = arguments.integrator;
  if (line.was_given("--free")) options.use_published = !arguments.free;
  return options;
}

}  // namespace quadtune::cli
