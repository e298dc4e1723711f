// SPDX-License-Identifier: Apache-2.0
/// How far a campaign is, shard by shard, and what one worker did.
#pragma once

#include <cstdint>
#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/simulation/campaign_shard.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "quadtune/workbench/campaign/campaign_run.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const CampaignPlan& plan, const CampaignStatus& status);
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const CampaignStatus& status);

/// What a worker did on one shard.
[[nodiscard]] internal::Json to_json(std::uint32_t shard, const ShardWork& work);
[[nodiscard]] std::string to_text(std::uint32_t shard, const ShardWork& work);

/// A bar, how many flights are done, and the time that is left.
/// @param seconds  since the work began
[[nodiscard]] std::string progress_line(const CampaignProgress& now, double seconds);

}  // namespace quadtune::report
