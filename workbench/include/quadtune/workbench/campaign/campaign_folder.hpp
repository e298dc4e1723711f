// SPDX-License-Identifier: Apache-2.0
/// A campaign on disk: its plan and scripts, the progress of its shards, and the records of its
/// flights.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign/campaign.hpp"
#include "quadtune/simulation/campaign/campaign_shard.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// Writes the plan and its scripts into a folder that has no plan, or the same plan.
/// @param made    plan and its files
/// @param folder  created if it is missing
/// @param stop    called before files are put in place; if it returns true, Interrupted is thrown
/// @return        whether the folder already had the same plan
/// @throws InvalidInput  if the folder has another plan; names the first key that differs
/// @throws FileError, Interrupted
bool write_campaign(const MadeCampaign& made, const std::string& folder,
                    const std::function<bool()>& stop = {});

/// Progress of a shard.
struct ShardProgressReport {
  std::string state;                ///< "done", "running", "stopped", "damaged" or "waiting"
  std::uint64_t records = 0,        ///< number of valid records on disk
      expected = 0;                 ///< number of records of the complete shard
  std::vector<std::string> damage;  ///< as ShardState::damage
};

/// Progress of a campaign.
struct CampaignStatus {
  std::vector<ShardProgressReport> shards;  ///< one for each shard
  std::uint64_t records = 0,                ///< number of valid records on disk
      expected = 0;                         ///< number of records of the complete campaign
  int known_workers = 0;                    ///< running workers whose rate is known
  /// Estimated time until all flights are flown [s], if as many workers continue and those without
  /// a known rate are as fast as the others; 0 if all are flown; not finite if no rate is known.
  double left = 0;
};

/// @throws FileError  as shard_state()
[[nodiscard]] CampaignStatus campaign_status(const CampaignPlan& plan, const std::string& folder);

/// The records of all shards, in the order of the flight numbers.
/// @param plan    of the campaign
/// @param folder  of the campaign
/// @param stop    called regularly; if it returns true, Interrupted is thrown
/// @throws InvalidInput  naming the shards that are missing or damaged
[[nodiscard]] std::vector<CampaignRecord> all_records(const CampaignPlan& plan,
                                                      const std::string& folder,
                                                      const std::function<bool()>& stop = {});

/// Numbers of the flights that keep a full log.
[[nodiscard]] std::set<std::uint64_t> kept_flights(const CampaignPlan& plan,
                                                   const std::vector<CampaignRecord>& records);

/// A flight of the campaign, with the description of its case.
[[nodiscard]] PlannedFlight replayed_flight(const CampaignPlan& plan, std::uint64_t number);

}  // namespace quadtune
