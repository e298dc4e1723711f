// SPDX-License-Identifier: Apache-2.0
/// From the flown shards of a campaign to what is read: records, statistics, table, database, logs.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/simulation/campaign.hpp"
#include "quadtune/simulation/campaign_statistics.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {

/// All flights of a campaign, put together. The same however the flights were shared among shards,
/// threads and machines.
struct MergedCampaign {
  std::vector<CampaignRecord> records;  ///< of all flights, in the order of their numbers
  Eigen::MatrixXd drawn;                ///< all_draws() of the campaign
  CampaignStatistics statistics;
};

/// @param threads  to use; 0: one for each processor
/// @param stop     asked now and then; true ends the work with Interrupted
/// @throws InvalidInput  naming the shards that are missing or damaged
/// @throws FileError, Interrupted
[[nodiscard]] MergedCampaign merge_campaign(const CampaignPlan& plan, const std::string& folder,
                                            std::size_t threads = 0,
                                            const std::function<bool()>& stop = {});

/// Writes flights.csv and campaign.sqlite into the folder, each whole or not at all.
/// @param threads, stop  as merge_campaign()
/// @return  the paths of both
/// @throws FileError, Interrupted
[[nodiscard]] std::vector<std::string> write_campaign_tables(
    const CampaignPlan& plan, const MergedCampaign& merged, const std::string& folder,
    std::size_t threads = 0, const std::function<bool()>& stop = {});

/// Flies one flight of the campaign again, with every control period kept.
/// @param number  of the flight, less than plan.campaign.records()
/// @return        the log as a MAT file; its name is the path in the campaign's folder
/// @throws OptionError  as keep_log()
/// @throws FileError, Interrupted
[[nodiscard]] FileContent campaign_log(const CampaignPlan& plan, const std::string& folder,
                                       std::uint64_t number,
                                       const std::function<bool()>& stop = {});

}  // namespace quadtune
