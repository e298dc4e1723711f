// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign_shard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <utility>

#include "campaign_records.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using internal::kRecordHeaderSize;
using internal::kRecordSize;
using internal::RecordHeader;

/// Draws that are flown between two writes: enough to keep all threads busy.
constexpr std::uint32_t kDrawsAtOnce = 256;

std::string stem(std::uint32_t shard) { return fmt::format("{:05}", shard); }
fs::path file_of(const CampaignFolder& folder, std::uint32_t shard) {
  return folder.path / (stem(shard) + ".flights");
}

RecordHeader header_of(const CampaignFolder& folder, std::uint32_t shard) {
  const DrawRange draws = shard_draws(folder.flights, folder.shards, shard);
  std::string plan = folder.plan;
  plan.resize(24);
  return {plan, shard, folder.shards, std::uint64_t{draws.begin} * folder.cases,
          std::uint64_t{draws.end - draws.begin} * folder.cases};
}

/// Where a worker's part lies. A worker that was killed leaves its own.
std::vector<fs::path> parts_of(const CampaignFolder& folder, std::uint32_t shard) {
  std::vector<fs::path> parts;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder.path, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(stem(shard) + ".") && name.ends_with(".part"))
      parts.push_back(entry.path());
  }
  std::sort(parts.begin(), parts.end());
  return parts;
}

using Records = std::map<std::uint64_t, CampaignRecord>;

/// Takes what is right of a file.
/// @param whole  whether all records must be there, in order
/// @return       what is wrong, "" where nothing is
std::string take_file(const fs::path& path, const RecordHeader& expected, bool whole,
                      Records& records) {
  std::string bytes;
  constexpr std::size_t kLimit = std::size_t{1} << 36;
  bytes = internal::read_file(path.string(), kLimit);
  const auto header = internal::read_header(bytes);
  if (!header)
    return fmt::format("{}: the first {} bytes are not as they were written",
                       path.filename().string(), kRecordHeaderSize);
  if (!(*header == expected))
    return fmt::format("{}: it belongs to another plan or shard", path.filename().string());
  std::string damage;
  std::uint64_t k = 0;
  std::size_t at = kRecordHeaderSize;
  for (; at + kRecordSize <= bytes.size(); at += kRecordSize, ++k) {
    const auto record = internal::read_record(std::span(bytes).subspan(at, kRecordSize));
    const bool mine = record && record->number >= expected.first &&
                      record->number < expected.first + expected.count &&
                      (!whole || record->number == expected.first + k);
    if (mine)
      records.emplace(record->number, *record);
    else if (damage.empty())
      damage = fmt::format("{}: record {} of {} is not as it was written (wrong checksum)",
                           path.filename().string(), k + 1, expected.count);
  }
  if (damage.empty() && whole && (at != bytes.size() || k != expected.count))
    damage = fmt::format("{}: it has {} bytes, expected {}", path.filename().string(), bytes.size(),
                         kRecordHeaderSize + expected.count * kRecordSize);
  return damage;
}

[[noreturn]] void fail(const fs::path& path) {
  throw FileError(path.string(), std::strerror(errno));
}

/// A file that is written from its beginning.
class Writer {
 public:
  Writer(fs::path path, int flags) : path_(std::move(path)) {
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | flags, 0666);
    if (file_ < 0) fail(path_);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() {
    if (file_ >= 0) ::close(file_);
  }

  void write(const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t count = ::write(file_, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(path_);
      done += static_cast<std::size_t>(count);
    }
  }
  void sync_and_close() {
    const int file = std::exchange(file_, -1);
    const bool synced = ::fsync(file) == 0 || errno == EINVAL;
    if (::close(file) != 0 || !synced) fail(path_);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  int file_ = -1;
};

/// A name that no other worker has: host and process, and a number where that was taken.
Writer open_part(const CampaignFolder& folder, std::uint32_t shard) {
  char host[256] = "host";
  if (::gethostname(host, sizeof host - 1) != 0) std::strcpy(host, "host");
  std::string name = host;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '-';
  for (int count = 0;; ++count) {
    const fs::path path =
        folder.path / fmt::format("{}.{}-{}-{}.part", stem(shard), name, ::getpid(), count);
    if (!fs::exists(path)) return Writer(path, O_EXCL);
  }
}

/// All that can be used of what lies in the folder.
Records found_records(const CampaignFolder& folder, std::uint32_t shard,
                      std::vector<std::string>& damage) {
  const RecordHeader expected = header_of(folder, shard);
  Records records;
  const fs::path file = file_of(folder, shard);
  if (fs::exists(file))
    if (const std::string what = take_file(file, expected, true, records); !what.empty())
      damage.push_back(what);
  for (const fs::path& part : parts_of(folder, shard)) {
    try {
      // A worker that was killed leaves a record that ends in the middle: that is no damage.
      const std::string what = take_file(part, expected, false, records);
      if (!what.empty() && fs::file_size(part) >= kRecordHeaderSize) damage.push_back(what);
    } catch (const FileError&) {
      // Another worker finished and took it away.
    }
  }
  return records;
}

/// Draws of which a record is missing.
std::vector<std::uint32_t> missing_draws(const RecordHeader& header, std::uint32_t cases,
                                         const Records& records) {
  std::vector<std::uint32_t> missing;
  for (std::uint64_t number = header.first; number < header.first + header.count; ++number) {
    const auto draw = static_cast<std::uint32_t>(number / cases);
    if (!records.contains(number) && (missing.empty() || missing.back() != draw))
      missing.push_back(draw);
  }
  return missing;
}

std::string bytes_of(const std::vector<CampaignRecord>& records) {
  std::string bytes;
  bytes.reserve(records.size() * kRecordSize);
  for (const CampaignRecord& record : records) internal::append(record, bytes);
  return bytes;
}

/// The shard's file, all of it or not at all; then the parts are of no more use.
void finish(const CampaignFolder& folder, std::uint32_t shard, const RecordHeader& header,
            const Records& records) {
  std::string bytes;
  bytes.reserve(kRecordHeaderSize + records.size() * kRecordSize);
  internal::append(header, bytes);
  for (const auto& [number, record] : records) internal::append(record, bytes);
  Writer writer = open_part(folder, shard);
  writer.write(bytes);
  writer.sync_and_close();
  const fs::path file = file_of(folder, shard);
  if (::rename(writer.path().c_str(), file.c_str()) != 0) {
    // A worker that finished first may have taken the part away.
    std::vector<std::string> damage;
    Records other;
    if (errno != ENOENT || !fs::exists(file) || !take_file(file, header, true, other).empty())
      fail(writer.path());
  }
  std::error_code ignored;
  for (const fs::path& part : parts_of(folder, shard)) fs::remove(part, ignored);
}

}  // namespace

ShardState shard_state(const CampaignFolder& folder, std::uint32_t shard) {
  ShardState state;
  state.expected = header_of(folder, shard).count;
  state.records = found_records(folder, shard, state.damage).size();
  const std::vector<fs::path> parts = parts_of(folder, shard);
  state.workers = static_cast<int>(parts.size());
  Records own;
  state.complete = fs::exists(file_of(folder, shard)) &&
                   take_file(file_of(folder, shard), header_of(folder, shard), true, own).empty();
  for (const fs::path& part : parts) {
    std::error_code gone;
    const auto time = fs::last_write_time(part, gone);
    if (gone) continue;
    const double ago =
        std::chrono::duration<double>(fs::file_time_type::clock::now() - time).count();
    if (state.last_written < 0 || ago < state.last_written) state.last_written = std::max(ago, 0.0);
  }
  return state;
}

std::vector<CampaignRecord> read_shard(const CampaignFolder& folder, std::uint32_t shard) {
  Records records;
  const fs::path file = file_of(folder, shard);
  const std::string damage = take_file(file, header_of(folder, shard), true, records);
  if (!damage.empty())
    throw InvalidInput((folder.path / damage.substr(0, damage.find(": "))).string(),
                       fmt::format("{}; `campaign work` with --shard {} flies what is missing",
                                   damage.substr(damage.find(": ") + 2), shard));
  std::vector<CampaignRecord> result;
  result.reserve(records.size());
  for (auto& [number, record] : records) result.push_back(std::move(record));
  return result;
}

ShardWork fly_shard(const Campaign& campaign, const CampaignFolder& folder, std::uint32_t shard,
                    std::size_t threads, const ShardProgress& progress,
                    const std::function<bool()>& interrupted) {
  ShardWork work;
  const RecordHeader header = header_of(folder, shard);
  Records records = found_records(folder, shard, work.damage);
  work.found = records.size();
  if (records.size() == header.count && work.damage.empty() && fs::exists(file_of(folder, shard)) &&
      parts_of(folder, shard).empty()) {
    work.was_complete = true;
    return work;
  }
  const std::vector<std::uint32_t> missing = missing_draws(header, folder.cases, records);
  if (!missing.empty()) {
    Writer part = open_part(folder, shard);
    std::string bytes;
    internal::append(header, bytes);
    part.write(bytes);
    for (std::size_t i = 0; i < missing.size();) {
      // As many as follow one another.
      std::size_t end = i + 1;
      while (end < missing.size() && end - i < kDrawsAtOnce && missing[end] == missing[end - 1] + 1)
        ++end;
      const std::vector<CampaignRecord> flown =
          fly_draws(campaign, missing[i], missing[end - 1] + 1, threads, interrupted);
      part.write(bytes_of(flown));
      for (const CampaignRecord& record : flown)
        if (records.emplace(record.number, record).second) ++work.flown;
      i = end;
      if (progress) progress(records.size(), header.count);
    }
  }
  finish(folder, shard, header, records);
  return work;
}

}  // namespace quadtune
