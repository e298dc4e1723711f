// SPDX-License-Identifier: Apache-2.0
/// Records of flights as bytes, each with its checksum: docs/formats.md says which byte is what.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign.hpp"

namespace quadtune::internal {

inline constexpr std::size_t kReasonLength = 48;  ///< with the zero that ends it
inline constexpr std::size_t kRecordSize = 24 + 8 * kMetrics + kReasonLength;
inline constexpr std::size_t kRecordHeaderSize = 64;

/// What a file of records says of itself.
struct RecordHeader {
  std::string plan;  ///< the first 24 digits of its SHA-256
  std::uint32_t shard = 0;
  std::uint32_t shards = 0;
  std::uint64_t first = 0;  ///< number of the first record
  std::uint64_t count = 0;  ///< of records when it is complete

  friend bool operator==(const RecordHeader&, const RecordHeader&) = default;
};

void append(const RecordHeader& header, std::string& bytes);
void append(const CampaignRecord& record, std::string& bytes);

/// None where the bytes are not what append() wrote.
[[nodiscard]] std::optional<RecordHeader> read_header(std::span<const char> bytes);
[[nodiscard]] std::optional<CampaignRecord> read_record(std::span<const char> bytes);

}  // namespace quadtune::internal
