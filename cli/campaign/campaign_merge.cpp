// SPDX-License-Identifier: Apache-2.0
#include "campaign/campaign_merge.hpp"

#include <fmt/format.h>

#include "arguments/flight_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "quadtune/simulation/campaign_table.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "report/flights/campaign_report.hpp"
#include "report/flights/flight_story.hpp"

namespace quadtune::cli {

namespace fs = std::filesystem;

MergedCampaign merge_campaign(const CampaignPlan& plan, const std::string& folder,
                              Context& context) {
  const std::vector<CampaignRecord> records = all_records(plan, folder, interrupted);
  MergedCampaign merged;
  const std::size_t threads = internal::thread_count(context.threads);
  const Eigen::MatrixXd drawn = all_draws(plan.campaign, threads);
  merged.statistics = campaign_statistics(plan.campaign, drawn, records, threads);
  const auto path = [&](const std::string& name) { return (fs::path(folder) / name).string(); };
  const auto written = [&](const std::string& file) {
    merged.files.push_back(file);
    context.written.push_back(file);
  };
  const auto write = [&](const std::string& file, const std::string& bytes) {
    write_file(file, bytes);
    written(file);
  };
  const std::string csv = path("flights.csv"), database = path("campaign.sqlite");
  const auto write_table = [&](std::size_t which) {
    if (which == 0)
      write_campaign_csv(csv, plan.campaign, drawn, records, interrupted);
    else
      write_campaign_database(database, plan.campaign, drawn, records, interrupted);
  };
  {
    const WritingFiles writing;
    internal::in_parallel(
        2, threads, [&] { return write_table; }, interrupted);
  }
  written(csv);
  written(database);
  write(path("statistics.json"),
        internal::readable(to_json(plan, merged.statistics, folder)) + "\n");
  write(path("report.html"), campaign_html(plan, merged.statistics, records, folder));
  for (const std::uint64_t number : kept_flights(plan, records)) {
    if (interrupted()) throw Interrupted();
    PlannedFlight flight = replayed_flight(plan, number);
    option_of_command("campaign merge", [&] { keep_log(flight); });
    const FlownFlight flown = fly_planned(std::move(flight), interrupted);
    const std::string file = path(fmt::format("logs/flight-{}.mat", number));
    write(file, log_bytes(flown.result.log, file));
  }
  return merged;
}

}  // namespace quadtune::cli
