// SPDX-License-Identifier: Apache-2.0
/// Tuning over missions as `tune pid` and `tune lqr` share it: options, the search, what it tells.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arguments/flight_arguments.hpp"
#include "quadtune/workbench/missions/mission_requirements.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"

namespace quadtune::cli {

class CommandLine;

struct Context;

struct MissionTuningArguments {
  std::string vehicle;  ///< name or file
  std::vector<std::string> missions;
  std::string requirements, estimator, sensors, wind;  ///< empty where they did not come
  std::optional<double> duration;
  double budget = 60;                                        ///< [s]
  std::uint64_t evaluations = 100000, draws = 0, proof = 0;  ///< 0: not said
  std::string measure;
  std::string file, report;
  bool force = false;
};

/// --mission, --requirements, --budget, --evaluations, --monte-carlo, --proof, --measure,
/// --estimator, --sensors, --wind, --duration, -o, --force, --report.
void add_mission_tuning_options(CommandLine& line, MissionTuningArguments& arguments);

/// Refuses words and numbers that no tuning takes, before anything is designed.
/// @throws UsageError
void require_sane(const std::string& verb, const MissionTuningArguments& arguments);
/// What --mission, --requirements and the options beside them ask for.
/// @throws UsageError, InvalidInput, FileError
[[nodiscard]] MissionRequirements mission_requirements(const std::string& verb,
                                                       const MissionTuningArguments& arguments);

/// A design file is written into a name by which it is known again, or to a device.
/// @throws UsageError
void require_design_name(const std::string& file, const std::string& verb);

/// Searches, proves, tells, and writes where something better was found; a page whatever was found.
/// @throws AnswerIsNo   where nothing better was found
/// @throws Interrupted  after it told and wrote the best found, where a signal ended the search
/// @param verb  "tune pid"
void run_mission_tuning(const std::string& verb, const MissionTuning& tuning,
                        const MissionRequirements& requirements,
                        const MissionTuningArguments& arguments, Context& context);

}  // namespace quadtune::cli
