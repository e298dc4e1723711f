// SPDX-License-Identifier: Apache-2.0
/// From the flown shards of a campaign to what is read: table, database, statistics, page, logs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign_statistics.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune::cli {

struct Context;

struct MergedCampaign {
  CampaignStatistics statistics;
  std::vector<std::string> files;  ///< that were written
};

/// Writes flights.csv, campaign.sqlite, statistics.json, report.html and the logs that are kept.
/// The same bytes however the flights were shared among shards, threads and machines.
/// @throws InvalidInput  naming the shards that are missing or damaged
/// @throws FileError, Interrupted
[[nodiscard]] MergedCampaign merge_campaign(const CampaignPlan& plan, const std::string& folder,
                                            Context& context);

}  // namespace quadtune::cli
