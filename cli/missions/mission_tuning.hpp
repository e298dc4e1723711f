// SPDX-License-Identifier: Apache-2.0
/// Tuning over missions as `tune pid` and `tune lqr` share it: options, the search, what it tells.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "arguments/flight_arguments.hpp"
#include "quadtune/workbench/missions/mission_requirements.hpp"
#include "quadtune/internal/json_fwd.hpp"

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

/// A vehicle's name or file as a text of TOML, for a design file that may be moved.
/// @throws InvalidInput  if no TOML can hold it
[[nodiscard]] std::string vehicle_text(const std::string& word);

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

/// A design as the search has it and as it is told.
struct TunedDesign {
  DesignPoint point;
  std::vector<NamedMargins> margins;
};

/// One of the numbers that are tuned.
struct TunedNumber {
  std::string of;    ///< e.g. a loop; may be empty
  std::string name;  ///< e.g. "Kp"
  std::string unit;
  double value = 0;
};

/// Another controller to hold the result against.
struct Rival {
  std::string name;
  Controller controller;
  std::vector<NamedMargins> margins;
  std::vector<TunedNumber> numbers;
};

/// What is tuned.
struct MissionTuning {
  std::string verb;  ///< "tune pid"
  Vehicle vehicle;
  std::string law;  ///< the start in words
  double position_bandwidth = 0;
  std::vector<std::string> names;  ///< of the numbers that are searched
  Eigen::VectorXd start;
  std::function<TunedDesign(const Eigen::VectorXd&)> design;
  std::optional<Rival> rival;
  std::string gains_title;  ///< of the table of `numbers`
  std::function<std::vector<TunedNumber>(const Eigen::VectorXd&)> numbers;
  /// Gains as text, JSON and as a file that `quadtune design` reads.
  std::function<std::string(const Eigen::VectorXd& before, const Eigen::VectorXd& after)> text;
  std::function<internal::Json(const Eigen::VectorXd&)> json;
  std::function<std::string(const Eigen::VectorXd&, const std::string& comment)> file;
};

/// Searches, proves, tells, and writes where something better was found; a page whatever was found.
/// @throws AnswerIsNo   where nothing better was found
/// @throws Interrupted  after it told and wrote the best found, where a signal ended the search
void run_mission_tuning(const MissionTuning& tuning, const MissionRequirements& requirements,
                        const MissionTuningArguments& arguments, Context& context);

}  // namespace quadtune::cli
