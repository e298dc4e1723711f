// SPDX-License-Identifier: Apache-2.0
/// The plan of a campaign: all data that determine its flights, fixed once, so that workers on any
/// machine fly the same flights.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/simulation/campaign/campaign.hpp"
#include "quadtune/simulation/campaign/campaign_shard.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// Name of the plan file in a campaign's folder; the plan refers to further files.
inline constexpr char kPlanName[] = "plan.json";

/// Which flights keep a full log.
struct CampaignKeep {
  int failures = 5;  ///< number of failed flights, first ones first
  int sample = 0;    ///< number of flights spread evenly over all
};

/// A campaign with everything that its flights depend on.
struct CampaignPlan {
  std::string name;                  ///< of the campaign
  std::string hash;                  ///< SHA-256 of the plan's file
  Campaign campaign;                 ///< cases, uncertainty, number of draws and seed
  std::uint32_t shards = 1;          ///< number of shards, ≥ 1
  CampaignKeep keep;                 ///< flights whose logs are written when the campaign is merged
  std::vector<PlannedFlight> words;  ///< description of each case, without its setup
};

/// A plan and the files from which load_plan() restores it.
struct MadeCampaign {
  CampaignPlan plan;               ///< the plan
  std::vector<FileContent> files;  ///< the hash of the plan last
};

/// Reads a campaign file (docs/formats.md) and computes the gains that it requests.
/// @param file    campaign file
/// @param shards  0: the number in the file, or a number for which a shard takes some minutes
/// @param seed    replaces that of the file
/// @throws InvalidInput  "file:line: …"
/// @throws FileError, NoSolution
[[nodiscard]] MadeCampaign make_campaign(const std::filesystem::path& file, std::uint32_t shards,
                                         const std::optional<std::uint64_t>& seed = {});

/// Loads a plan and checks that no file was changed since it was written.
/// @throws InvalidInput  if a file was changed or another version wrote the plan; names it
/// @throws FileError     if there is no plan
[[nodiscard]] CampaignPlan load_plan(const std::filesystem::path& folder);

/// The folder and layout of the plan's records.
[[nodiscard]] CampaignFolder folder_of(const CampaignPlan& plan,
                                       const std::filesystem::path& folder);

}  // namespace quadtune
