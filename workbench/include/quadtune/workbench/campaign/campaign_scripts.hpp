// SPDX-License-Identifier: Apache-2.0
/// Scripts that fly a campaign's shards by the engines that clusters have.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {

/// slurm.sh, a job array for sbatch, and parallel.sh, for GNU parallel here or over ssh. Both call
/// $QUADTUNE, or the quadtune of the path.
/// @param folder  absolute, the same on all machines
[[nodiscard]] std::vector<FileContent> campaign_scripts(const CampaignPlan& plan,
                                                        const std::filesystem::path& folder);

/// A word as a shell takes it whole.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace quadtune
