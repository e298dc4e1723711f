// SPDX-License-Identifier: Apache-2.0
/// Options of `pid V`: what is asked of a vehicle's cascade.
#pragma once

#include <string>
#include <vector>

#include "quadtune/workbench/design/cascade_options.hpp"

namespace quadtune::cli {

class CommandLine;

struct CascadeArguments {
  double dt = 0;             // [s]
  std::string bandwidth;     // "roll=40,x=2" [rad/s]
  std::string sensor_delay;  // "0.005" or "roll=0.005,x=0.02" [s]
  double motor_lag = 0;      // [s]
  double tracking_max = 0;   // max |value / set point|
  std::string integral;      // names
  std::string integrator = "euler";
  bool free = false;
};

/// Adds --dt, --bandwidth, --sensor-delay, --motor-lag, --tracking-max, --integral, --integrator,
/// --free.
void add_cascade_options(CommandLine& line, CascadeArguments& arguments);

/// The options' names, for refusals.
[[nodiscard]] const std::vector<std::string>& cascade_option_names();

/// Those of the options that were given.
/// @param line  after parse()
[[nodiscard]] CascadeOptions given_cascade_options(const CommandLine& line,
                                                   const CascadeArguments& arguments);

}  // namespace quadtune::cli
