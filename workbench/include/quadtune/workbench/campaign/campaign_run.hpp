// SPDX-License-Identifier: Apache-2.0
/// Flying a campaign: one shard, or all of them one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "quadtune/simulation/campaign_shard.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {

/// How far the work is.
struct CampaignProgress {
  std::uint64_t flown = 0;    ///< since the work began, > 0
  std::uint64_t missing = 0;  ///< yet to be flown
  std::uint64_t all = 0;      ///< of the shard or campaign; > 0
};

/// What is asked and told while a campaign is flown. Any may be empty.
struct CampaignWatch {
  std::function<void(const CampaignProgress&)> progress;  ///< called now and then, by any thread
  /// Called when a shard is complete.
  std::function<void(std::uint32_t shard, const ShardWork&)> shard_done;
  std::function<bool()> stop;  ///< true ends the work with Interrupted; what was flown stays
};

/// Flies what is missing of one shard.
/// @param shard    from 0, less than plan.shards
/// @param threads  to use; 0: one for each processor
/// @throws InvalidInput, FileError, Interrupted  as fly_shard()
ShardWork fly_campaign_shard(const CampaignPlan& plan, const std::string& folder,
                             std::uint32_t shard, std::size_t threads = 0,
                             const CampaignWatch& watch = {});

/// Flies what is missing of all shards; others may work on the same folder meanwhile.
/// @throws  as fly_campaign_shard()
void fly_campaign(const CampaignPlan& plan, const std::string& folder, std::size_t threads = 0,
                  const CampaignWatch& watch = {});

}  // namespace quadtune
