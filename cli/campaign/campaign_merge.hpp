// SPDX-License-Identifier: Apache-2.0
/// From the flown shards of a campaign to what is read: table, database, statistics, page, logs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "arguments/flight_arguments.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/simulation/campaign_statistics.hpp"

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

/// A flight of the campaign with its words.
[[nodiscard]] PlannedFlight replayed_flight(const CampaignPlan& plan, std::uint64_t number);

}  // namespace quadtune::cli
