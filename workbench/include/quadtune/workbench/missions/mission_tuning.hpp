// SPDX-License-Identifier: Apache-2.0
/// Gains that are tuned over missions: what is searched, how it is flown, and what came out.
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

/// A design at one point of the search.
struct TunedDesign {
  DesignPoint point;  ///< no controller for a point whose loops are not stable
  std::vector<NamedMargins> margins;
};

/// One number of a design.
struct TunedNumber {
  std::string of;    ///< e.g. a loop; may be empty
  std::string name;  ///< e.g. "Kp"
  std::string unit;
  double value = 0;
};

/// Diagonal weights of an LQR, and their gains where the Riccati equation has a solution.
struct TunedWeights {
  std::vector<std::string> names;
  Eigen::VectorXd weights;
  std::optional<Gains> gains;
};

/// The gains of a design: a PID cascade's, or an LQR's with the weights that it is searched by.
using TunedGains = std::variant<CascadeGains, TunedWeights>;

/// A design that what is found is compared with.
struct Rival {
  std::string name;
  Controller controller;
  std::vector<NamedMargins> margins;
  std::vector<TunedNumber> numbers;
};

/// What is searched.
struct MissionTuning {
  Vehicle vehicle;
  std::string law;  ///< the start in words
  double position_bandwidth = 0;
  std::vector<std::string> names;  ///< of the numbers that are searched
  Eigen::VectorXd start;
  std::function<TunedDesign(const Eigen::VectorXd&)> design;
  std::optional<Rival> rival;
  std::string gains_title;  ///< of the table of `numbers`
  std::function<std::vector<TunedNumber>(const Eigen::VectorXd&)> numbers;
  std::function<TunedGains(const Eigen::VectorXd&)> gains;
  /// A file that `quadtune design` and `fly --gains` read.
  std::function<std::string(const Eigen::VectorXd&, const std::string& comment)> file;
};

/// How it is searched.
struct MissionTuningOptions {
  double seconds = 60;                 ///< of the search, > 0
  std::uint64_t evaluations = 100000;  ///< designs that are tried at most, ≥ 1
  std::uint32_t draws = 0;             ///< of each mission; 0: the requirements', or 4
  std::uint32_t proof = 0;             ///< fresh draws; 0: 24, or what a quantile needs
  std::uint64_t seed = 1;
  std::size_t threads = 0;  ///< 0: one for each processor
  /// Asked now and then; true ends the search with the best that was found.
  std::function<bool()> stop = {};
  /// Called from time to time with the best cost, the designs tried, and the time left [s].
  std::function<void(double best, int evaluations, double left)> progress = {};
};

/// A limit of a mission that is tighter than the sensors can keep.
struct TunedLimit {
  std::string mission;
  WidenedLimit limit;
};

/// What will be flown for the cost.
struct MissionTuningPlan {
  TunedDesign start;
  TrialRequest request;
  PlannedFlight first;  ///< of the first mission
  std::vector<TunedLimit> widened;
  std::vector<std::string> notes;  ///< what the user should know of choices
  std::uint32_t proof = 0;         ///< fresh draws
};

/// Plans the missions with the start's law.
/// @param who  asked, for the message of NoSolution
/// @throws NoSolution    if the start is not stable
/// @throws OptionError   "proof" for fewer fresh draws than a quantile needs, or an option of
/// flights
/// @throws InvalidInput  for requirements of loops that are not there
[[nodiscard]] MissionTuningPlan plan_mission_tuning(const MissionTuning& tuning,
                                                    const MissionRequirements& requirements,
                                                    const MissionTuningOptions& options,
                                                    const std::string& who);

/// What came out.
struct MissionTuningResult {
  MissionTuning tuning;
  TrialRequest request;
  MissionSearchResult search;
  std::vector<NamedMargins> before, after;  ///< of the loops: start, the best point
  std::vector<DesignLimit> limits;          ///< of the margins, as the best point has them
  std::optional<TrialOutcome> rival;        ///< on the draws of the proof
  FlownEvidence flown = {};
  std::vector<TunedLimit> widened = {};
  std::shared_ptr<const MissionTrial> trial;  ///< flies any of the missions again
};

/// Searches, proves what was found on fresh draws, and judges its flown loop: a point whose flown
/// loop is unstable is not accepted.
[[nodiscard]] MissionTuningResult tune_missions(const MissionTuning& tuning,
                                                const MissionRequirements& requirements,
                                                MissionTuningPlan plan,
                                                const MissionTuningOptions& options);

/// Distances from the reference over time.
struct DistanceOverTime {
  std::vector<double> time, value;  ///< [s], [m]; empty for a mission without a reference

  /// The last value at or before a time; NaN after the flight.
  [[nodiscard]] double at(double t) const;
};

/// One mission, flown by several controllers on the same draw.
struct TunedFlights {
  std::string mission;
  std::vector<DistanceOverTime> distances;  ///< of the start, the best point, and the rival
};

/// Flies each mission with the start, the best point and the rival, on the first of the fresh
/// draws. A mission whose record would not fit into memory ends the list.
/// @throws Interrupted  where `stop` says so
[[nodiscard]] std::vector<TunedFlights> tuned_flights(const MissionTuningResult& result,
                                                      const std::function<bool()>& stop = {});

/// A vehicle's name or path as a TOML text: a path becomes absolute.
/// @throws InvalidInput  for a path that is not UTF-8
[[nodiscard]] std::string vehicle_text(const std::string& word);

}  // namespace quadtune
