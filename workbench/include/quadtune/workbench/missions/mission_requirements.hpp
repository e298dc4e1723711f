// SPDX-License-Identifier: Apache-2.0
/// What gains are asked for when they are tuned over missions: a cost, limits of missions and of
/// margins, and what is uncertain. From a requirements file (docs/formats.md) or the command line.
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

/// Margins that a loop must keep; what is not said is not asked for.
struct MarginLimits {
  std::optional<double> Ms_max;
  std::optional<double> phase_min;  ///< [rad]
  std::optional<double> gain_min;   ///< factor
  std::optional<double> delay_min;  ///< [s]
};

struct MissionRequirements {
  std::vector<CampaignMission> missions;
  std::vector<std::vector<Limit>> limits;  ///< of each mission, in place of its own by metric
  std::vector<CostTerm> cost = {{Metric::tracking_rms, 1}, {Metric::settling_time, 0.5}};
  RobustMeasure measure = RobustMeasure::mean;
  double share = 0.9;
  std::optional<std::uint32_t> draws;
  Uncertainty uncertainty;
  std::optional<MarginLimits> margins;        ///< of every loop
  std::map<std::string, MarginLimits> loops;  ///< of one by name, beside those of all
  std::string where;                          ///< of [loops], for messages
};

/// @throws InvalidInput  "file:line: …"
[[nodiscard]] MissionRequirements read_requirements(const std::filesystem::path& file);

/// A loop with its margins.
struct NamedMargins {
  std::string name;
  LoopMargins margins;
};

/// The limits that loops must keep; where nothing is asked of margins, that no Ms is greater than
/// it is at the start.
/// @throws InvalidInput  for a loop that is not there
[[nodiscard]] std::vector<DesignLimit> margin_limits(const MissionRequirements& requirements,
                                                     const std::vector<NamedMargins>& loops,
                                                     const std::vector<NamedMargins>& start);

}  // namespace quadtune
