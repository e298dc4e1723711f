// SPDX-License-Identifier: Apache-2.0
/// Binary records of flights with checksums; docs/formats.md describes each byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign/campaign.hpp"

namespace quadtune::internal {

inline constexpr std::size_t kReasonLength = 48;  ///< including the terminating zero
inline constexpr std::size_t kRecordSize = 24 + 8 * kMetrics + kReasonLength;
inline constexpr std::size_t kRecordHeaderSize = 64;

/// Header of a file of records.
struct RecordHeader {
  std::string plan;  ///< the first 24 digits of its SHA-256
  std::uint32_t shard = 0;
  std::uint32_t shards = 0;
  std::uint64_t first = 0;  ///< number of the first record
  std::uint64_t count = 0;  ///< number of records in the complete file

  friend bool operator==(const RecordHeader&, const RecordHeader&) = default;
};

void append(const RecordHeader& header, std::string& bytes);
void append(const CampaignRecord& record, std::string& bytes);

/// Parses a header; empty if the bytes were not written by append().
[[nodiscard]] std::optional<RecordHeader> read_header(std::span<const char> bytes);
[[nodiscard]] std::optional<CampaignRecord> read_record(std::span<const char> bytes);

}  // namespace quadtune::internal
