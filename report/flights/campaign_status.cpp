// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>

#include "quadtune/internal/json.hpp"
#include "quadtune/simulation/campaign/campaign_shard.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/campaign/campaign_run.hpp"
#include "report/flights/flights.hpp"

namespace quadtune::report {

internal::Json to_json(const CampaignPlan& plan) {
  return {{"name", plan.name},
          {"sha256", plan.hash},
          {"flights", plan.campaign.flights},
          {"cases", plan.campaign.cases.size()},
          {"records", plan.campaign.records()},
          {"shards", plan.shards}};
}

std::string to_text(const CampaignPlan& plan, const std::string& folder, bool was_there) {
  const std::vector<CampaignCase>& cases = plan.campaign.cases;
  std::string text = fmt::format("{}: {} draws in {} case{}, {} shard{}{}\n", plan.name,
                                 plan.campaign.flights, cases.size(), cases.size() == 1 ? "" : "s",
                                 plan.shards, plan.shards == 1 ? "" : "s",
                                 was_there ? "; the folder already contained this plan" : "");
  for (std::size_t i = 0; i < cases.size(); ++i)
    text += fmt::format("  {} in {}: {}; {}\n", cases[i].design, cases[i].mission,
                        plan.words[i].law, surroundings(plan.words[i]));
  return text +
         fmt::format(
             "to fly it: {0}/parallel.sh here or over ssh, sbatch {0}/slurm.sh on a cluster, or\n"
             "        quadtune campaign work {0} --shard 0 and so on; then\n"
             "        quadtune campaign merge {0}\n",
             folder);
}

using internal::Json;

Json to_json(const CampaignPlan& plan, const CampaignStatus& status) {
  Json shards = Json::array();
  for (std::size_t i = 0; i < status.shards.size(); ++i) {
    const ShardProgressReport& shard = status.shards[i];
    shards.push_back({{"shard", i},
                      {"state", shard.state},
                      {"records", shard.records},
                      {"expected", shard.expected},
                      {"damage", shard.damage}});
  }
  return {{"name", plan.name},
          {"records", status.records},
          {"expected", status.expected},
          {"left_s", status.left},
          {"shards", shards}};
}

std::string to_text(const CampaignPlan& plan, const CampaignStatus& status) {
  std::map<std::string, int> counts;
  std::string lines;
  for (std::size_t i = 0; i < status.shards.size(); ++i) {
    const ShardProgressReport& shard = status.shards[i];
    ++counts[shard.state];
    if (shard.state == "done" || shard.state == "waiting") continue;
    lines += fmt::format("shard {}: {}, {} of {} flights\n", i, shard.state, shard.records,
                         shard.expected);
    for (const std::string& damage : shard.damage) lines += "  " + damage + "\n";
  }
  std::string text =
      fmt::format("{}: {} of {} flights", plan.name, status.records, status.expected);
  for (const auto& [state, count] : counts)
    text += fmt::format(", {} shard{} {}", count, count == 1 ? "" : "s", state);
  if (status.records < status.expected && status.known_workers > 0)
    text += fmt::format(", about {:.0f} s left", status.left);
  return text + "\n" + lines;
}

Json to_json(std::uint32_t shard, const ShardWork& work) {
  return {{"shard", shard},
          {"was_complete", work.was_complete},
          {"found", work.found},
          {"flown", work.flown},
          {"damage", work.damage}};
}

std::string to_text(std::uint32_t shard, const ShardWork& work) {
  if (work.was_complete)
    return fmt::format("shard {} was complete: {} flights, verified\n", shard, work.found);
  return fmt::format("shard {}: {} flown, {} found\n", shard, work.flown, work.found);
}

std::string progress_line(const CampaignProgress& now, double seconds) {
  const double left = seconds / static_cast<double>(now.flown) * static_cast<double>(now.missing);
  const std::uint64_t done = now.all - now.missing;
  constexpr std::size_t kWidth = 30;
  const auto filled = static_cast<std::size_t>(kWidth * done / now.all);
  return fmt::format("[{:#<{}}{:.<{}}] {} of {} flights, {:.0f} s left", "", filled, "",
                     kWidth - filled, done, now.all, left);
}

}  // namespace quadtune::report
