// SPDX-License-Identifier: Apache-2.0
/// Merges the flown shards of a campaign into records, statistics, a table, a database and logs.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/simulation/campaign/campaign.hpp"
#include "quadtune/simulation/campaign/campaign_statistics.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {

/// The merged flights of a campaign. The result does not depend on how the flights were divided
/// among shards, threads and machines.
struct MergedCampaign {
  std::vector<CampaignRecord> records;  ///< of all flights, ordered by flight number
  Eigen::MatrixXd drawn;                ///< all_draws() of the campaign
  CampaignStatistics statistics;        ///< of all flights
};

/// @param plan     of the campaign
/// @param folder   of the campaign, all shards complete
/// @param threads  number of threads; 0: one per processor
/// @param stop     called regularly; if it returns true, Interrupted is thrown
/// @throws InvalidInput  if shards are missing or damaged; names them
/// @throws FileError, Interrupted
[[nodiscard]] MergedCampaign merge_campaign(const CampaignPlan& plan, const std::string& folder,
                                            std::size_t threads = 0,
                                            const std::function<bool()>& stop = {});

/// Writes flights.csv and campaign.sqlite into the folder, each atomically.
/// @param plan           of the campaign
/// @param merged         from merge_campaign()
/// @param folder         of the campaign
/// @param threads, stop  as merge_campaign()
/// @return               the two paths
/// @throws FileError, Interrupted
[[nodiscard]] std::vector<std::string> write_campaign_tables(
    const CampaignPlan& plan, const MergedCampaign& merged, const std::string& folder,
    std::size_t threads = 0, const std::function<bool()>& stop = {});

/// Flies one flight of the campaign again and logs every control period.
/// @param plan    of the campaign
/// @param folder  of the campaign, for the name of the log
/// @param number  of the flight, less than plan.campaign.records()
/// @param stop    called regularly; if it returns true, Interrupted is thrown
/// @return        the log as a MAT file; its name is the path within the campaign's folder
/// @throws OptionError  as keep_log()
/// @throws FileError, Interrupted
[[nodiscard]] FileContent campaign_log(const CampaignPlan& plan, const std::string& folder,
                                       std::uint64_t number,
                                       const std::function<bool()>& stop = {});

}  // namespace quadtune
