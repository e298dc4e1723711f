// SPDX-License-Identifier: Apache-2.0
/// Tunes gains over missions: search variables, flights and results.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/tuning/mission_search.hpp"
#include "quadtune/tuning/mission_trial.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/missions/flown_evidence.hpp"
#include "quadtune/workbench/missions/mission_requirements.hpp"

namespace quadtune {

/// A design at one point of the search space.
struct TunedDesign {
  DesignPoint point;  ///< no controller if a loop is unstable
  std::vector<NamedMargins> margins;
};

/// One number of a design.
struct TunedNumber {
  std::string of;    ///< what it belongs to, e.g. a loop; may be empty
  std::string name;  ///< e.g. "Kp"
  std::string unit;
  double value = 0;
};

/// Diagonal weights of an LQR, and their gains if the Riccati equation has a solution.
struct TunedWeights {
  std::vector<std::string> names;
  Eigen::VectorXd weights;
  std::optional<Gains> gains;
};

/// The gains of a design: those of a PID cascade, or of an LQR with its weights.
using TunedGains = std::variant<CascadeGains, TunedWeights>;

/// A design with which the result is compared.
struct Rival {
  std::string name;
  Controller controller;
  std::vector<NamedMargins> margins;
  std::vector<TunedNumber> numbers;
};

/// The search problem.
struct MissionTuning {
  Vehicle vehicle;
  std::string law;  ///< description of the start
  double position_bandwidth = 0;
  std::vector<std::string> names;  ///< of the search variables
  Eigen::VectorXd start;
  std::function<TunedDesign(const Eigen::VectorXd&)> design;
  std::optional<Rival> rival;
  std::string gains_title;  ///< title of the table of `numbers`
  std::function<std::vector<TunedNumber>(const Eigen::VectorXd&)> numbers;
  std::function<TunedGains(const Eigen::VectorXd&)> gains;
  /// The text of a file that `quadtune design` and `fly --gains` accept.
  std::function<std::string(const Eigen::VectorXd&, const std::string& comment)> file;
};

/// Options of the search.
struct MissionTuningOptions {
  double seconds = 60;                 ///< duration of the search, > 0
  std::uint64_t evaluations = 100000;  ///< maximum number of designs tried, ≥ 1
  std::uint32_t draws = 0;             ///< per mission; 0: as in the requirements, or 4
  std::uint32_t proof = 0;             ///< number of fresh draws; 0: 24, or as many as a quantile
                                       ///< requires
  std::uint64_t seed = 1;
  std::size_t threads = 0;  ///< 0: one per processor
  /// Called regularly; if it returns true, the search ends with the best result so far.
  std::function<bool()> stop = {};
  /// Called regularly with the best cost, the number of designs tried, and the time left [s].
  std::function<void(double best, int evaluations, double left)> progress = {};
};

/// A limit of a mission that is tighter than the sensors allow.
struct TunedLimit {
  std::string mission;
  WidenedLimit limit;
};

/// The flights that determine the cost.
struct MissionTuningPlan {
  TunedDesign start;
  TrialRequest request;
  PlannedFlight first;  ///< of the first mission
  std::vector<TunedLimit> widened;
  std::vector<std::string> notes;  ///< about choices, for the user
  std::uint32_t proof = 0;         ///< fresh draws
};

/// Plans the missions with the initial law.
/// @param who  name of the caller, for the message of NoSolution
/// @throws NoSolution    if the start is unstable
/// @throws OptionError   "proof" if there are fewer fresh draws than a quantile requires; or for an
///                       option of the flights
/// @throws InvalidInput  if the requirements name a loop that does not exist
[[nodiscard]] MissionTuningPlan plan_mission_tuning(const MissionTuning& tuning,
                                                    const MissionRequirements& requirements,
                                                    const MissionTuningOptions& options,
                                                    const std::string& who);

/// The result of a tuning.
struct MissionTuningResult {
  MissionTuning tuning;
  TrialRequest request;
  MissionSearchResult search;
  std::vector<NamedMargins> before, after;  ///< of the loops: at the start, at the best point
  std::vector<DesignLimit> limits;          ///< of the margins at the best point
  std::optional<TrialOutcome> rival;        ///< on the fresh draws
  FlownEvidence flown = {};
  std::vector<TunedLimit> widened = {};
  std::shared_ptr<const MissionTrial> trial;  ///< can fly any of the missions again
};

/// Searches, evaluates the result on fresh draws, and analyses its flown loop: a point with an
/// unstable flown loop is rejected.
[[nodiscard]] MissionTuningResult tune_missions(const MissionTuning& tuning,
                                                const MissionRequirements& requirements,
                                                MissionTuningPlan plan,
                                                const MissionTuningOptions& options);

/// Distances from the reference over time.
struct DistanceOverTime {
  std::vector<double> time, value;  ///< [s], [m]; empty if the mission has no reference

  /// The last value at or before time t; NaN after the end of the flight.
  [[nodiscard]] double at(double t) const;
};

/// One mission, flown by several controllers on the same draw.
struct TunedFlights {
  std::string mission;
  std::vector<DistanceOverTime> distances;  ///< of the start, the best point, and the rival
};

/// Flies each mission with the start, the best point and the rival, with the first of the fresh
/// draws. The list ends before the first mission whose log would not fit into memory.
/// @throws Interrupted  if `stop` returns true
[[nodiscard]] std::vector<TunedFlights> tuned_flights(const MissionTuningResult& result,
                                                      const std::function<bool()>& stop = {});

/// A vehicle's name or path as TOML text; a path becomes absolute.
/// @throws InvalidInput  if the path is not UTF-8
[[nodiscard]] std::string vehicle_text(const std::string& word);

}  // namespace quadtune
