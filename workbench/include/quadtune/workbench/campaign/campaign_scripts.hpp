// SPDX-License-Identifier: Apache-2.0
/// Scripts that fly a campaign's shards with the schedulers of clusters.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {

/// slurm.sh, a job array for sbatch, and parallel.sh, for GNU parallel on this machine or over ssh.
/// Both call $QUADTUNE, or the quadtune in PATH.
/// @param plan    of the campaign
/// @param folder  absolute, the same on all machines
[[nodiscard]] std::vector<FileContent> campaign_scripts(const CampaignPlan& plan,
                                                        const std::filesystem::path& folder);

/// Quotes a word so that a shell reads it as one argument.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace quadtune
