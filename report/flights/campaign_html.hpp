// SPDX-License-Identifier: Apache-2.0
/// The page of a campaign.
#pragma once

#include <span>
#include <string>

#include "quadtune/simulation/campaign_statistics.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune::report {

/// The page as one HTML file.
/// @param records  all of the campaign, in order
/// @param folder   the campaign's, for the commands that fly a flight again
[[nodiscard]] std::string campaign_html(const CampaignPlan& plan,
                                        const CampaignStatistics& statistics,
                                        std::span<const CampaignRecord> records,
                                        const std::string& folder);

}  // namespace quadtune::report
