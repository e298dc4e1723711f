// SPDX-License-Identifier: Apache-2.0
#include "campaign/campaign_merge.hpp"

#include <fmt/format.h>

#include <set>

#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "quadtune/simulation/campaign_table.hpp"
#include "report/flights/campaign_report.hpp"
#include "report/flights/flight_story.hpp"

namespace quadtune::cli {
namespace {

namespace fs = std::filesystem;

std::vector<CampaignRecord> all_records(const CampaignPlan& plan, const std::string& path) {
  const CampaignFolder folder = folder_of(plan, path);
  std::vector<CampaignRecord> records;
  records.reserve(plan.campaign.records());
  std::vector<std::string> missing;
  for (std::uint32_t shard = 0; shard < plan.shards; ++shard) {
    if (interrupted()) throw Interrupted();
    if (!shard_is_there(folder, shard)) {
      missing.push_back(fmt::format("{}", shard));
      continue;
    }
    for (CampaignRecord& record : read_shard(folder, shard)) records.push_back(std::move(record));
  }
  if (!missing.empty()) {
    constexpr std::size_t kNamed = 10;
    const std::size_t more = missing.size() > kNamed ? missing.size() - kNamed : 0;
    const std::string first = missing.front();
    missing.resize(missing.size() - more);
    throw InvalidInput(
        path, fmt::format("shard{} {}{} {} not complete, expected all {}: `quadtune campaign work "
                          "{} --shard {}` flies what is missing",
                          missing.size() + more == 1 ? "" : "s", internal::joined(missing, ", "),
                          more > 0 ? fmt::format(" and {} more", more) : "",
                          missing.size() + more == 1 ? "is" : "are", plan.shards, path, first));
  }
  return records;
}

/// Numbers of the flights that leave a log.
std::set<std::uint64_t> kept_flights(const CampaignPlan& plan,
                                     const std::vector<CampaignRecord>& records) {
  std::set<std::uint64_t> kept;
  int failures = 0;
  for (const CampaignRecord& record : records) {
    if (failures == plan.keep.failures) break;
    if (record.passed) continue;
    kept.insert(record.number);
    ++failures;
  }
  const auto sample = static_cast<std::uint64_t>(plan.keep.sample);
  for (std::uint64_t i = 0; i < sample; ++i) kept.insert(i * records.size() / sample);
  return kept;
}

}  // namespace

PlannedFlight replayed_flight(const CampaignPlan& plan, std::uint64_t number) {
  PlannedFlight flight = plan.words[number % plan.campaign.cases.size()];
  flight.setup = setup_of(plan.campaign, number);
  return flight;
}

MergedCampaign merge_campaign(const CampaignPlan& plan, const std::string& folder,
                              Context& context) {
  const std::vector<CampaignRecord> records = all_records(plan, folder);
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
