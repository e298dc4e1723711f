// SPDX-License-Identifier: Apache-2.0
/// Flies a campaign: one shard, or all shards one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "quadtune/simulation/campaign/campaign_shard.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {

/// Progress of the work.
struct CampaignProgress {
  std::uint64_t flown = 0;    ///< since this call, > 0
  std::uint64_t missing = 0;  ///< still to be flown
  std::uint64_t all = 0;      ///< all flights of the shard or campaign, > 0
};

/// Callbacks while a campaign is flown. Each may be empty.
struct CampaignWatch {
  std::function<void(const CampaignProgress&)> progress;  ///< called regularly, by any thread
  /// Called when a shard is complete.
  std::function<void(std::uint32_t shard, const ShardWork&)> shard_done;
  std::function<bool()> stop;  ///< if it returns true, Interrupted is thrown; completed flights are
                               ///< kept
};

/// Flies the missing flights of one shard.
/// @param plan     of the campaign
/// @param folder   of the campaign
/// @param shard    from 0, less than plan.shards
/// @param threads  number of threads; 0: one per processor
/// @param watch    callbacks; each may be empty
/// @throws InvalidInput, FileError, Interrupted  as fly_shard()
ShardWork fly_campaign_shard(const CampaignPlan& plan, const std::string& folder,
                             std::uint32_t shard, std::size_t threads = 0,
                             const CampaignWatch& watch = {});

/// Flies the missing flights of all shards; other processes may work on the same folder.
/// @throws  as fly_campaign_shard()
void fly_campaign(const CampaignPlan& plan, const std::string& folder, std::size_t threads = 0,
                  const CampaignWatch& watch = {});

}  // namespace quadtune
