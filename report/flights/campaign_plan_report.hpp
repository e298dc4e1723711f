// SPDX-License-Identifier: Apache-2.0
/// The plan of a campaign as text and as JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const CampaignPlan& plan);
/// Its cases, and the commands that fly it.
/// @param folder      the campaign's
/// @param was_there  whether the folder had this plan already
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const std::string& folder,
                                  bool was_there);

}  // namespace quadtune::report
