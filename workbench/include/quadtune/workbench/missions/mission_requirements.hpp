// SPDX-License-Identifier: Apache-2.0
/// Requirements on gains that are tuned over missions: a cost, limits of missions and of margins,
/// and the uncertainty. From a requirements file (docs/formats.md) or the command line.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/synthesis/margins.hpp"
#include "quadtune/tuning/mission_search.hpp"
#include "quadtune/workbench/campaign/campaign_file.hpp"

namespace quadtune {

/// Required margins of a loop; members without a value are not required.
struct MarginLimits {
  std::optional<double> Ms_max;
  std::optional<double> phase_min;  ///< [rad]
  std::optional<double> gain_min;   ///< factor
  std::optional<double> delay_min;  ///< [s]
};

struct MissionRequirements {
  std::vector<CampaignMission> missions;
  std::vector<std::vector<Limit>> limits;  ///< for each mission; replace its own limit on the same
                                           ///< metric
  std::vector<CostTerm> cost = {{Metric::tracking_rms, 1}, {Metric::settling_time, 0.5}};
  RobustMeasure measure = RobustMeasure::mean;
  double share = 0.9;
  std::optional<std::uint32_t> draws;
  Uncertainty uncertainty;
  std::optional<MarginLimits> margins;        ///< of all loops
  std::map<std::string, MarginLimits> loops;  ///< of single loops by name, in addition to those of
                                              ///< all loops
  std::string where;                          ///< of [loops], for messages
};

/// @throws InvalidInput  "file:line: …"
[[nodiscard]] MissionRequirements read_requirements(const std::filesystem::path& file);

/// The missions of a search and its requirements, in words.
struct MissionWords {
  std::vector<std::string> missions;     ///< names of built-in missions, or files
  std::string requirements;              ///< file; empty: none
  std::string measure;                   ///< as in the file; empty: that of the file
  std::string estimator, sensors, wind;  ///< of the flights, as in FlightOptions; empty: not given
  std::optional<double> duration;        ///< of each flight [s]
};

/// Validates the words about the flights before anything is designed.
/// @throws OptionError  naming the member
void require_flight_words(const MissionWords& words);

/// The requirements that the words describe.
/// @throws OptionError  if nothing names a mission, or if the file names the missions, too; a wrong
///                      member is named by its key, and `missions` by "mission"
/// @throws InvalidInput, FileError  as read_requirements() and load_mission()
[[nodiscard]] MissionRequirements mission_requirements(const MissionWords& words);

/// A loop with its margins.
struct NamedMargins {
  std::string name;
  LoopMargins margins;
};

/// The limits on the margins of the loops. If no margins are required, no Ms may exceed its initial
/// value.
/// @throws InvalidInput  if a named loop does not exist
[[nodiscard]] std::vector<DesignLimit> margin_limits(const MissionRequirements& requirements,
                                                     const std::vector<NamedMargins>& loops,
                                                     const std::vector<NamedMargins>& start);

}  // namespace quadtune
