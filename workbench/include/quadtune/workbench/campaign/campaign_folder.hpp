// SPDX-License-Identifier: Apache-2.0
/// A campaign on disk: its plan and scripts, how far its shards are, and the flights that were
/// flown.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign.hpp"
#include "quadtune/simulation/campaign_shard.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// Writes the plan and its scripts into a folder that has no plan, or has the same.
/// @param stop  asked before files are put in place; true ends the work with Interrupted
/// @return      whether the same plan was there already
/// @throws InvalidInput  for a folder with another plan, naming the first key that differs
/// @throws FileError, Interrupted
bool write_campaign(const MadeCampaign& made, const std::string& folder,
                    const std::function<bool()>& stop = {});

/// How far a shard is.
struct ShardProgressReport {
  std::string state;  ///< "done", "running", "stopped", "damaged" or "waiting"
  std::uint64_t records = 0, expected = 0;
  std::vector<std::string> damage;  ///< as ShardState::damage
};

/// How far a campaign is.
struct CampaignStatus {
  std::vector<ShardProgressReport> shards;
  std::uint64_t records = 0, expected = 0;
  int known_workers = 0;  ///< running workers whose rate is known
  /// Time until all is flown if as many workers go on, those that have not written yet as fast as
  /// the others [s]; 0 where all is flown; not finite where nobody knows.
  double left = 0;
};

/// @throws FileError  as shard_state()
[[nodiscard]] CampaignStatus campaign_status(const CampaignPlan& plan, const std::string& folder);

/// The records of all shards, in the order of their numbers.
/// @param stop  asked now and then; true ends the work with Interrupted
/// @throws InvalidInput  naming the shards that are missing or damaged
[[nodiscard]] std::vector<CampaignRecord> all_records(const CampaignPlan& plan,
                                                      const std::string& folder,
                                                      const std::function<bool()>& stop = {});

/// Numbers of the flights that leave a log.
[[nodiscard]] std::set<std::uint64_t> kept_flights(const CampaignPlan& plan,
                                                   const std::vector<CampaignRecord>& records);

/// A flight of the campaign with its words.
[[nodiscard]] PlannedFlight replayed_flight(const CampaignPlan& plan, std::uint64_t number);

}  // namespace quadtune
