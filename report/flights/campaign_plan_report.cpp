// SPDX-License-Identifier: Apache-2.0
#include "report/flights/campaign_plan_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/flights/flight_text.hpp"

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
  std::string text =
      fmt::format("{}: {} draws in {} case{}, {} shard{}{}\n", plan.name, plan.campaign.flights,
                  cases.size(), cases.size() == 1 ? "" : "s", plan.shards,
                  plan.shards == 1 ? "" : "s", was_there ? "; the plan was there already" : "");
  for (std::size_t i = 0; i < cases.size(); ++i)
    text += fmt::format("  {} in {}: {}; {}\n", cases[i].design, cases[i].mission,
                        plan.words[i].law, surroundings(plan.words[i]));
  return text +
         fmt::format(
             "fly it: {0}/parallel.sh here or over ssh, sbatch {0}/slurm.sh on a cluster, or\n"
             "        quadtune campaign work {0} --shard 0 and so on; then\n"
             "        quadtune campaign merge {0}\n",
             folder);
}

}  // namespace quadtune::report
