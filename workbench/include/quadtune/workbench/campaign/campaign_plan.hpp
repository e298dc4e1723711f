// SPDX-License-Identifier: Apache-2.0
/// The plan of a campaign: everything that its flights are made of, fixed once, so that workers on
/// any machine fly the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/simulation/campaign.hpp"
#include "quadtune/simulation/campaign_shard.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// The plan's file in a campaign's folder, and those that it names.
inline constexpr char kPlanName[] = "plan.json";

/// Which flights leave a full log.
struct CampaignKeep {
  int failures = 5;  ///< the first that fail
  int sample = 0;    ///< spread evenly over all
};

struct CampaignPlan {
  std::string name;
  std::string hash;  ///< SHA-256 of the plan's file
  Campaign campaign;
  std::uint32_t shards = 1;
  CampaignKeep keep;
  std::vector<PlannedFlight> words;  ///< of each case, without its setup
};

/// A plan, and the files from which load_plan() reads it back.
struct MadeCampaign {
  CampaignPlan plan;
  std::vector<FileContent> files;  ///< the plan's hash last
};

/// Reads a campaign file (docs/formats.md) and computes the gains that it asks for.
/// @param shards  0: as the file says, or such that one takes some minutes
/// @throws InvalidInput  "file:line: …"
/// @throws FileError, NoSolution
[[nodiscard]] MadeCampaign make_campaign(const std::filesystem::path& file, std::uint32_t shards);

/// Reads a plan back and checks that nothing was changed since it was written.
/// @throws InvalidInput  naming what was changed, or the version that wrote it
/// @throws FileError     where there is no plan
[[nodiscard]] CampaignPlan load_plan(const std::filesystem::path& folder);

/// Where the plan's records lie.
[[nodiscard]] CampaignFolder folder_of(const CampaignPlan& plan,
                                       const std::filesystem::path& folder);

}  // namespace quadtune
