// SPDX-License-Identifier: Apache-2.0
/// Shards of a campaign on disk. Any number of workers can fly them and be killed and restarted at
/// any time; no record is lost or counted twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign/campaign.hpp"

namespace quadtune {

/// Folder with the records of a campaign, and the plan to which they must belong.
struct CampaignFolder {
  /// Contains SHARD.flights, and SHARD.WORKER.part while the shard is flown
  std::filesystem::path path;
  std::string plan;           ///< SHA-256 of the plan, 64 hexadecimal digits
  std::uint32_t flights = 0;  ///< number of draws
  std::uint32_t cases = 0;    ///< number of cases
  std::uint32_t shards = 0;   ///< number of shards, ≥ 1
};

/// State of a shard on disk.
struct ShardState {
  bool complete = false;       ///< the shard's file exists and every record in it is valid
  std::uint64_t records = 0;   ///< number of valid records, in the shard's file and in the parts
  std::uint64_t expected = 0;  ///< number of records of a complete shard
  std::vector<std::string> damage;  ///< one line per file that is damaged
  int workers = 0;                  ///< number of parts, one per worker, running or not
  double last_written = -1;         ///< age of the newest part [s]; negative: there is no part
  /// [records/s] of the worker that wrote the newest part; 0: not known yet
  double rate = 0;
};
/// Reads the state of a shard.
/// @param folder  with the plan
/// @param shard   0 ≤ shard < `shards` of the folder, here and below
/// @throws FileError  if the shard's file exists and cannot be read
[[nodiscard]] ShardState shard_state(const CampaignFolder& folder, std::uint32_t shard);

/// Whether the file of a completed shard exists. Its records are not validated.
[[nodiscard]] bool shard_is_there(const CampaignFolder& folder, std::uint32_t shard);

/// Reads the records of a complete shard.
/// @throws InvalidInput  naming the file and the invalid record
/// @throws FileError     if the file is missing or cannot be read
[[nodiscard]] std::vector<CampaignRecord> read_shard(const CampaignFolder& folder,
                                                     std::uint32_t shard);

/// Result of fly_shard().
struct ShardWork {
  bool was_complete = false;  ///< nothing had to be flown
  std::uint64_t found = 0;    ///< number of valid records from previous workers
  std::uint64_t flown = 0;    ///< number of flights that this call flew
  /// Damage that was found; the affected flights were flown again
  std::vector<std::string> damage;
};

/// Progress of a worker: flights that it has flown, and flights of the shard that are still
/// missing.
using ShardProgress = std::function<void(std::uint64_t flown, std::uint64_t missing)>;

/// Flies the missing flights of a shard. Records are appended to a file of this worker as they are
/// computed. When the shard is complete, its records are written in order to a temporary file,
/// which then atomically replaces the shard's file. Records of other workers are used if their
/// checksums are correct. Two workers on the same shard both fly all of it and write identical
/// bytes.
/// @param campaign     that the plan describes
/// @param folder       with the plan
/// @param shard        0 ≤ shard < `shards` of the folder
/// @param threads      as fly_all()
/// @param progress     called regularly; may be empty
/// @param interrupted  as fly_all()
/// @throws FileError     with the path and the operating system's reason; completed flights remain
///                       in the part
/// @throws Interrupted   completed flights remain in the part
/// @throws InvalidInput  as fly_all()
ShardWork fly_shard(const Campaign& campaign, const CampaignFolder& folder, std::uint32_t shard,
                    std::size_t threads = 0, const ShardProgress& progress = {},
                    const std::function<bool()>& interrupted = {});

}  // namespace quadtune
