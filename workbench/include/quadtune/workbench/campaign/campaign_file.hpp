// SPDX-License-Identifier: Apache-2.0
/// What a campaign file asks for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/simulation/uncertainty.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// [[design]]: gains as `quadtune fly` takes them.
struct CampaignDesign {
  std::string name, gains, controller, integrator;
  std::string where;  ///< "file:line"
};

/// [[mission]]: how it is flown.
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
  std::uint32_t shards = 0;  ///< 0: not said
  CampaignKeep keep;
};

/// One [[mission]] of a campaign or requirements file.
/// @param folder  where a mission's file is looked for
/// @param more    keys that the table may have beside those that are read
[[nodiscard]] CampaignMission read_campaign_mission(
    const internal::TomlTable& table, const std::filesystem::path& folder,
    const std::vector<internal::TomlKey>& more = {});

/// @throws InvalidInput  "file:line: …"
[[nodiscard]] CampaignRequest read_campaign(const std::filesystem::path& file);

}  // namespace quadtune
