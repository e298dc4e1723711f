// SPDX-License-Identifier: Apache-2.0
/// How far a campaign is, shard by shard.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const CampaignPlan& plan, const CampaignStatus& status);
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const CampaignStatus& status);

}  // namespace quadtune::report
