// SPDX-License-Identifier: Apache-2.0
/// A campaign's statistics as text, as JSON and as a page.
#pragma once

#include <span>
#include <string>

#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/simulation/campaign_statistics.hpp"

namespace quadtune::report {

/// @param folder  the campaign's, for the commands that fly a flight again
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const CampaignStatistics& statistics,
                                  const std::string& folder);
[[nodiscard]] internal::Json to_json(const CampaignPlan& plan, const CampaignStatistics& statistics,
                                     const std::string& folder);

/// The page of it all.
/// @param records  all of the campaign, in order
[[nodiscard]] std::string campaign_html(const CampaignPlan& plan,
                                        const CampaignStatistics& statistics,
                                        std::span<const CampaignRecord> records,
                                        const std::string& folder);

/// "estimator mambo, real sensors, wind calm"
[[nodiscard]] std::string surroundings(const PlannedFlight& words);

/// The command that flies one flight again.
[[nodiscard]] std::string replay_command(const std::string& folder, std::uint64_t number);

}  // namespace quadtune::report
