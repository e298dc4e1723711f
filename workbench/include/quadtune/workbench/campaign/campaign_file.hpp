// SPDX-License-Identifier: Apache-2.0
/// The contents of a campaign file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/campaign/uncertainty.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// [[design]]: gains, in the words that `quadtune fly` accepts.
struct CampaignDesign {
  std::string name, gains, controller, integrator;
  std::string where;  ///< "file:line"
};

/// [[mission]]: a mission and how it is flown.
struct CampaignMission {
  Mission mission;
  FlightOptions arguments;  ///< estimator, sensors, flow, wind, duration, …
  std::string where;
};

struct CampaignRequest {
  std::string name;
  std::string vehicle;        ///< name or path
  std::string vehicle_where;  ///< "file:line"
  std::vector<CampaignDesign> designs;
  std::vector<CampaignMission> missions;
  Uncertainty uncertainty;
  std::uint32_t flights = 0;
  std::uint64_t seed = 1;
  std::uint32_t shards = 0;  ///< 0: not given
  CampaignKeep keep;
};

/// One [[mission]] of a campaign or requirements file.
/// @param folder  folder that the path of a mission file is relative to
/// @param more    further keys that the table may have
[[nodiscard]] CampaignMission read_campaign_mission(
    const internal::TomlTable& table, const std::filesystem::path& folder,
    const std::vector<internal::TomlKey>& more = {});

/// @throws InvalidInput  "file:line: …"
[[nodiscard]] CampaignRequest read_campaign(const std::filesystem::path& file);

}  // namespace quadtune
