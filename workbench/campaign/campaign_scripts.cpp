// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_scripts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace quadtune {

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) ||
           std::string_view("/._-+:,@%=").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<FileContent> campaign_scripts(const CampaignPlan& plan,
                                          const std::filesystem::path& folder) {
  const std::string place = shell_word(folder.string());
  const std::string slurm = fmt::format(
      "#!/bin/sh\n"
      "# One job per shard: sbatch slurm.sh. A stopped job resumes where it was. Options of\n"
      "# your cluster (--partition, --time, --cpus-per-task) go before the file name.\n"
      "# FIRST_SHARD is added to the indices of the array, for clusters that limit them.\n"
      "#SBATCH --job-name={}\n"
      "#SBATCH --array=0-{}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output=shard-%a.log\n"
      "exec \"${{QUADTUNE:-quadtune}}\" campaign work {} \\\n"
      "  --shard \"$((SLURM_ARRAY_TASK_ID + ${{FIRST_SHARD:-0}}))\" \\\n"
      "  --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
      plan.name, plan.shards - 1, place);
  const std::string parallel = fmt::format(
      "#!/bin/sh\n"
      "# Flies as many shards at once as there are processors. Options are passed to "
      "parallel:\n"
      "# --sshlogin host1,host2 uses these hosts, on which this folder must have the same path.\n"
      "# A further call flies what failed.\n"
      "seq 0 {} | parallel --joblog {}/parallel.log --resume-failed \"$@\" \\\n"
      "  \"${{QUADTUNE:-quadtune}}\" campaign work {} --shard {{}} --threads 1\n",
      plan.shards - 1, place, place);
  return {{"slurm.sh", slurm}, {"parallel.sh", parallel}};
}

}  // namespace quadtune
