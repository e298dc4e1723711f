// SPDX-License-Identifier: Apache-2.0
/// Tuning over missions as `tune pid` and `tune lqr` share it: options, the search, what it tells.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "flight_arguments.hpp"
#include "mission_requirements.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {

struct Context;

struct MissionTuningArguments {
  std::string vehicle;  ///< name or file
  std::vector<std::string> missions;
  std::string requirements, estimator, sensors, wind = "calm";
  std::optional<double> duration;
  double budget = 60;  ///< [s]
  std::uint64_t evaluations = 100000, draws = 4, proof = 24;
  std::string measure;
  std::string file;
  bool force = false;
};

/// --mission, --requirements, --budget, --evaluations, --monte-carlo, --proof, --measure,
/// --estimator, --sensors, --wind, --duration, -o, --force.
void add_mission_tuning_options(CLI::App& app, MissionTuningArguments& arguments);

/// A design as the search has it and as it is told.
struct TunedDesign {
  DesignPoint point;
  std::vector<NamedMargins> margins;
};

/// Another controller to hold the result against.
struct Rival {
  std::string name;
  Controller controller;
  std::vector<NamedMargins> margins;
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
  /// Gains as text, JSON and as a file that `quadtune design` reads.
  std::function<std::string(const Eigen::VectorXd& before, const Eigen::VectorXd& after)> text;
  std::function<internal::Json(const Eigen::VectorXd&)> json;
  std::function<std::string(const Eigen::VectorXd&, const std::string& comment)> file;
};

/// Searches, proves, tells, and writes where something better was found.
/// @throws AnswerIsNo  where nothing better was found
void run_mission_tuning(const MissionTuning& tuning, const MissionTuningArguments& arguments,
                        Context& context);

}  // namespace quadtune::cli
