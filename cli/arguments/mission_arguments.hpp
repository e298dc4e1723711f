// SPDX-License-Identifier: Apache-2.0
/// What `tune pid` and `tune lqr` share: their options, the search, and its outputs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "program/refusal.hpp"
#include "quadtune/workbench/missions/mission_requirements.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"

namespace quadtune::cli {

class CommandLine;

struct Context;

struct MissionTuningArguments {
  std::string vehicle;  ///< name or file
  MissionWords words;
  double budget = 60;                                        ///< [s]
  std::uint64_t evaluations = 100000, draws = 0, proof = 0;  ///< 0: not given
  std::string file, report;
  bool force = false;
};

/// --mission, --requirements, --budget, --evaluations, --monte-carlo, --proof, --measure,
/// --estimator, --sensors, --wind, --duration, -o, --force, --report.
void add_mission_tuning_options(CommandLine& line, MissionTuningArguments& arguments);

/// Validates the options before anything is designed.
/// @throws UsageError
void require_sane(const MissionTuningArguments& arguments);

/// Requires that the name of a design file ends in .toml, by which it is recognized later, or is a
/// device.
/// @throws UsageError
void require_design_name(const std::string& file);

/// Searches, compares the result with the start on fresh draws, and prints it. Writes the design
/// file if the result is accepted or --force was given, and the page in any case.
/// @throws AnswerIsNo   if the search found nothing better than the start
/// @throws Interrupted  after the best result so far was printed and written, if a signal ended the
///                      search
void run_mission_tuning(const MissionTuning& tuning, const MissionRequirements& requirements,
                        const MissionTuningArguments& arguments, Context& context);

}  // namespace quadtune::cli
