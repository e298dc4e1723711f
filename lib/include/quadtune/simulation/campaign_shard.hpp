// SPDX-License-Identifier: Apache-2.0
/// Parts of a campaign on disk: flown by any number of workers, killed and begun again at any time,
/// with nothing lost and nothing counted twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign.hpp"

namespace quadtune {

/// Where a campaign's records lie, and which plan they must be of.
struct CampaignFolder {
  std::filesystem::path path;  ///< holds SHARD.flights, and SHARD.WORKER.part while it is flown
  std::string plan;            ///< SHA-256 of the plan, 64 digits
  std::uint32_t flights = 0;   ///< draws
  std::uint32_t cases = 0;
  std::uint32_t shards = 0;
};

/// What is on disk of a shard.
struct ShardState {
  bool complete = false;      ///< its file is there, and every record in it is right
  std::uint64_t records = 0;  ///< that are right, in its file and in the parts
  std::uint64_t expected = 0;
  std::vector<std::string> damage;  ///< one line for each file that is not as it was written
  int workers = 0;                  ///< parts, each of a worker that flies or flew
  double last_written = -1;         ///< [s] ago; of the newest part; negative: there is none
  double rate = 0;                  ///< [records/s] of that part's worker; 0: not known yet
};
/// @param shard  from 0, less than the folder's `shards`, here and below
/// @throws FileError  where the shard's file is there and cannot be read
[[nodiscard]] ShardState shard_state(const CampaignFolder& folder, std::uint32_t shard);

/// Whether the shard's file is there, complete when it was written. No record of it is read.
[[nodiscard]] bool shard_is_there(const CampaignFolder& folder, std::uint32_t shard);

/// The records of a complete shard.
/// @throws InvalidInput  naming the file and the record that is wrong
/// @throws FileError     where the file is missing or cannot be read
[[nodiscard]] std::vector<CampaignRecord> read_shard(const CampaignFolder& folder,
                                                     std::uint32_t shard);

/// What a worker did.
struct ShardWork {
  bool was_complete = false;  ///< nothing had to be flown
  std::uint64_t found = 0;    ///< records of workers before, verified
  std::uint64_t flown = 0;
  std::vector<std::string> damage;  ///< what was found wrong, and flown again
};

/// How far a worker is: flights that it flew, and those of the shard that are missing yet.
using ShardProgress = std::function<void(std::uint64_t flown, std::uint64_t missing)>;

/// Flies what is missing of a shard. Records are appended to a file of this worker as they come;
/// when all are there they are written in order beside the shard's file and take its place at once.
/// Records that other workers left are used where their checksums are right. Two workers at once
/// both do all of it, and leave the same bytes.
/// @param threads     as fly_all()
/// @throws FileError     with the path and the system's reason; what was flown stays in the part
/// @throws Interrupted   likewise
/// @throws InvalidInput  as fly_all()
ShardWork fly_shard(const Campaign& campaign, const CampaignFolder& folder, std::uint32_t shard,
                    std::size_t threads = 0, const ShardProgress& progress = {},
                    const std::function<bool()>& interrupted = {});

}  // namespace quadtune
