// SPDX-License-Identifier: Apache-2.0
/// A campaign's statistics as text and as JSON.
#pragma once

#include <cstdint>
#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/simulation/campaign_statistics.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune::report {

/// @param folder  the campaign's, for the commands that fly a flight again
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const CampaignStatistics& statistics,
                                  const std::string& folder);
[[nodiscard]] internal::Json to_json(const CampaignPlan& plan, const CampaignStatistics& statistics,
                                     const std::string& folder);

/// The command that flies one flight again.
[[nodiscard]] std::string replay_command(const std::string& folder, std::uint64_t number);

}  // namespace quadtune::report
