// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_run.hpp"

#include <algorithm>

namespace quadtune {

ShardWork fly_campaign_shard(const CampaignPlan& plan, const std::string& folder,
                             std::uint32_t shard, std::size_t threads, const CampaignWatch& watch) {
  const DrawRange draws = shard_draws(plan.campaign.flights, plan.shards, shard);
  const std::uint64_t all = std::uint64_t{draws.end - draws.begin} * plan.campaign.cases.size();
  ShardWork work = fly_shard(
      plan.campaign, folder_of(plan, folder), shard, threads,
      [&](std::uint64_t flown, std::uint64_t missing) {
        if (watch.progress) watch.progress({flown, missing, all});
      },
      watch.stop);
  if (watch.shard_done) watch.shard_done(shard, work);
  return work;
}

void fly_campaign(const CampaignPlan& plan, const std::string& folder, std::size_t threads,
                  const CampaignWatch& watch) {
  const CampaignFolder records = folder_of(plan, folder);
  const std::uint64_t all = plan.campaign.records();
  std::uint64_t missing = all, before = 0;  // before: flown by this call in earlier shards
  for (std::uint32_t shard = 0; shard < plan.shards; ++shard)
    missing -= shard_state(records, shard).records;
  CampaignWatch of_shard = watch;
  of_shard.progress = [&](const CampaignProgress& shard) {
    // Another worker may have flown, or lost, some of them in the meantime.
    const std::uint64_t together = before + shard.flown;
    if (watch.progress) watch.progress({together, missing - std::min(missing, together), all});
  };
  for (std::uint32_t shard = 0; shard < plan.shards; ++shard)
    before += fly_campaign_shard(plan, folder, shard, threads, of_shard).flown;
}

}  // namespace quadtune
