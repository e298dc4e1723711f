// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_merge.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "quadtune/simulation/campaign/campaign_table.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {

MergedCampaign merge_campaign(const CampaignPlan& plan, const std::string& folder,
                              std::size_t threads, const std::function<bool()>& stop) {
  MergedCampaign merged;
  merged.records = all_records(plan, folder, stop);
  const std::size_t used = internal::thread_count(threads);
  merged.drawn = all_draws(plan.campaign, used);
  merged.statistics = campaign_statistics(plan.campaign, merged.drawn, merged.records, used);
  return merged;
}

std::vector<std::string> write_campaign_tables(const CampaignPlan& plan,
                                               const MergedCampaign& merged,
                                               const std::string& folder, std::size_t threads,
                                               const std::function<bool()>& stop) {
  const std::string csv = (std::filesystem::path(folder) / "flights.csv").string();
  const std::string database = (std::filesystem::path(folder) / "campaign.sqlite").string();
  const auto write_table = [&](std::size_t which) {
    if (which == 0)
      write_campaign_csv(csv, plan.campaign, merged.drawn, merged.records, stop);
    else
      write_campaign_database(database, plan.campaign, merged.drawn, merged.records, stop);
  };
  internal::in_parallel(
      2, internal::thread_count(threads), [&] { return write_table; }, stop);
  return {csv, database};
}

FileContent campaign_log(const CampaignPlan& plan, const std::string& folder, std::uint64_t number,
                         const std::function<bool()>& stop) {
  if (stop && stop()) throw Interrupted();
  PlannedFlight flight = replayed_flight(plan, number);
  keep_log(flight);
  const FlownFlight flown = fly_planned(std::move(flight), stop);
  const std::string file =
      (std::filesystem::path(folder) / fmt::format("logs/flight-{}.mat", number)).string();
  return {file, log_bytes(flown.result.log, file)};
}

}  // namespace quadtune
