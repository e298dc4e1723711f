// SPDX-License-Identifier: Apache-2.0
#include "simulation/campaign/campaign_records.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace quadtune::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "records are written in memory order");

constexpr char kMagic[8] = {'q', 't', 'f', 'l', 'i', 'g', 'h', 't'};
constexpr std::uint32_t kFormat = 2;
constexpr std::size_t kDigits = 24;  // digits of the plan's hash

std::uint32_t checksum(const char* bytes, std::size_t size) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes), static_cast<uInt>(size)));
}

template <class T>
void put(T value, char*& at) {
  std::memcpy(at, &value, sizeof value);
  at += sizeof value;
}
template <class T>
T take(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return value;
}

/// Appends `size` bytes, the first four of which are a checksum of the others.
template <class Fill>
void append_block(std::size_t size, std::string& bytes, const Fill& fill) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + size, '\0');
  char* at = bytes.data() + begin + 4;
  fill(at);
  char* first = bytes.data() + begin;
  put(checksum(first + 4, size - 4), first);
}

}  // namespace

void append(const RecordHeader& header, std::string& bytes) {
  append_block(kRecordHeaderSize, bytes, [&](char*& at) {
    put(kFormat, at);
    std::memcpy(at, kMagic, sizeof kMagic);
    at += sizeof kMagic;
    put(header.shard, at);
    put(header.shards, at);
    put(header.first, at);
    put(header.count, at);
    std::memcpy(at, header.plan.data(), std::min(kDigits, header.plan.size()));
  });
}

std::optional<RecordHeader> read_header(std::span<const char> bytes) {
  if (bytes.size() < kRecordHeaderSize) return std::nullopt;
  const char* at = bytes.data();
  if (take<std::uint32_t>(at) != checksum(bytes.data() + 4, kRecordHeaderSize - 4) ||
      take<std::uint32_t>(at) != kFormat || std::memcmp(at, kMagic, sizeof kMagic) != 0)
    return std::nullopt;
  at += sizeof kMagic;
  RecordHeader header;
  header.shard = take<std::uint32_t>(at);
  header.shards = take<std::uint32_t>(at);
  header.first = take<std::uint64_t>(at);
  header.count = take<std::uint64_t>(at);
  header.plan.assign(at, kDigits);
  return header;
}

void append(const CampaignRecord& record, std::string& bytes) {
  append_block(kRecordSize, bytes, [&](char*& at) {
    put(static_cast<std::uint16_t>(record.end), at);
    put(static_cast<std::uint16_t>(record.passed ? 1 : 0), at);
    put(record.number, at);
    put(record.end_time, at);
    for (const double value : record.metrics.value) put(value, at);
    std::memcpy(at, record.reason.data(), std::min(record.reason.size(), kReasonLength - 1));
  });
}

std::optional<CampaignRecord> read_record(std::span<const char> bytes) {
  if (bytes.size() < kRecordSize) return std::nullopt;
  const char* at = bytes.data();
  if (take<std::uint32_t>(at) != checksum(bytes.data() + 4, kRecordSize - 4)) return std::nullopt;
  CampaignRecord record;
  const auto end = take<std::uint16_t>(at);
  const auto passed = take<std::uint16_t>(at);
  if (end > static_cast<std::uint16_t>(FlightEnd::diverged) || passed > 1) return std::nullopt;
  record.end = static_cast<FlightEnd>(end);
  record.passed = passed == 1;
  record.number = take<std::uint64_t>(at);
  record.end_time = take<double>(at);
  for (double& value : record.metrics.value) value = take<double>(at);
  record.reason.assign(at, strnlen(at, kReasonLength));
  return record;
}

}  // namespace quadtune::internal
