// SPDX-License-Identifier: Apache-2.0
/// quadtune tune pid: gains of a PID cascade over missions.
#include "arguments/mission_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/workbench/missions/pid_tuning.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  MissionTuningArguments tuning;
  std::string gains = "designed";
  bool separate = false;
};

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.tuning.vehicle, "a built-in vehicle or a vehicle file");
  add_mission_tuning_options(line, options.tuning);
  line.add_option("--gains WHICH", options.gains,
                  "designed (default), published or a file of gains, where the search starts");
  line.add_flag("--separate", options.separate, "tune x and y, and pitch and roll, separately");
}

void run_tune_pid(Options& options, Context& context) {
  if (options.tuning.vehicle.empty()) refuse("V", "expected a vehicle");
  require_sane(options.tuning);
  const MissionRequirements requirements = mission_requirements(options.tuning.words);
  const MissionTuning tuning = pid_tuning(options.tuning.vehicle, options.gains, options.separate);
  run_mission_tuning(tuning, requirements, options.tuning, context);
}

}  // namespace

Verb tune_pid_verb() {
  return {"tune pid", "V --mission NAME [options]",
          "search PID gains over missions, and validate them on fresh draws",
          "quadtune tune pid mambo --mission step-north --evaluations 100",
          with_options(add_options, run_tune_pid)};
}

}  // namespace quadtune::cli
