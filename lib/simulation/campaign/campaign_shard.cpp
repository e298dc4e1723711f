// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/campaign_shard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <map>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "simulation/campaign/campaign_records.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using internal::kRecordHeaderSize;
using internal::kRecordSize;
using internal::RecordHeader;

/// Number of draws that are flown between two writes: enough to keep all threads busy.
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

/// Paths of all parts of a shard. A killed worker leaves its part behind.
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

/// Reads the valid records of a file.
/// @param whole  whether all records must be present, in order
/// @return       a description of the damage; empty if there is none
std::string take_file(const fs::path& path, const RecordHeader& expected, bool whole,
                      Records& records) {
  constexpr std::size_t kLimit = std::size_t{1} << 36;
  const std::string bytes = internal::read_file(path.string(), kLimit);
  // A killed worker may leave less than a header, which does not count as damage.
  if (!whole && bytes.size() < kRecordHeaderSize) return "";
  const auto header = internal::read_header(bytes);
  if (!header)
    return fmt::format("{}: the header of {} bytes is damaged", path.filename().string(),
                       kRecordHeaderSize);
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
      damage =
          fmt::format("{}: record {} of {} {}", path.filename().string(), k + 1, expected.count,
                      record ? fmt::format("belongs to flight {}, expected another", record->number)
                             : "is damaged (wrong checksum)");
  }
  if (damage.empty() && whole && (at != bytes.size() || k != expected.count))
    damage = fmt::format("{}: it has {} bytes, expected {}", path.filename().string(), bytes.size(),
                         kRecordHeaderSize + expected.count * kRecordSize);
  return damage;
}

[[noreturn]] void fail(const fs::path& path) {
  throw FileError(path.string(), std::strerror(errno));
}

/// A file that only this worker writes, from its beginning.
class Writer {
 public:
  Writer(fs::path path, int file) : path_(std::move(path)), file_(file) {}
  Writer(Writer&& other) noexcept
      : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}
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
  /// Writes the bytes; if that fails, the file is removed, since its remains would be useless.
  void write_or_remove(const std::string& bytes, bool synced) {
    try {
      write(bytes);
      if (synced) sync_and_close();
    } catch (const FileError&) {
      std::error_code ignored;
      fs::remove(path_, ignored);
      throw;
    }
  }
  void sync_and_close() {
    // EINVAL: a file system that does not support fsync.
    if (::fsync(file_) != 0 && errno != EINVAL) fail(path_);
    if (::close(std::exchange(file_, -1)) != 0) fail(path_);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }
  /// Whether path() still names the written file. Writing to a file that was removed, alone or with
  /// its folder, succeeds, but the data are lost.
  [[nodiscard]] bool is_in_place() const {
    struct stat written = {}, there = {};
    return ::fstat(file_, &written) == 0 && ::stat(path_.c_str(), &there) == 0 &&
           written.st_dev == there.st_dev && written.st_ino == there.st_ino;
  }

 private:
  fs::path path_;
  int file_;
};

std::int64_t milliseconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

/// Opens a part with a unique name: host, process and start time, from which the rate is computed.
Writer open_part(const CampaignFolder& folder, std::uint32_t shard) {
  char host[256] = "host";
  if (::gethostname(host, sizeof host - 1) != 0) std::strcpy(host, "host");
  std::string name = host;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '-';
  for (std::int64_t time = milliseconds(std::chrono::system_clock::now());; ++time) {
    const fs::path path =
        folder.path / fmt::format("{}.{}-{}-{}.part", stem(shard), name, ::getpid(), time);
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return {path, file};
    if (errno != EEXIST) fail(path);
  }
}

/// Records per second of a part, from its creation to its last write; 0 if unknown.
double rate_of(const fs::path& part, fs::file_time_type written) {
  const std::string name = part.stem().string();
  std::int64_t began = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + name.rfind('-') + 1, end, began);
  const std::int64_t passed = milliseconds(std::chrono::file_clock::to_sys(written)) - began;
  std::error_code gone;
  const std::uintmax_t size = fs::file_size(part, gone);
  if (read.ec != std::errc() || read.ptr != end || passed <= 0 || gone || size < kRecordHeaderSize)
    return 0;
  const std::uintmax_t records = (size - kRecordHeaderSize) / kRecordSize;
  return 1000 * static_cast<double>(records) / static_cast<double>(passed);
}

/// All valid data in the folder.
struct Found {
  Records records;
  std::vector<std::string> damage;
  std::vector<fs::path> parts;
  bool complete = false;  ///< the shard's file exists and every record in it is valid
};
Found find_records(const CampaignFolder& folder, std::uint32_t shard) {
  const RecordHeader expected = header_of(folder, shard);
  Found found;
  const auto take = [&](const fs::path& path, bool whole) {
    const std::string what = take_file(path, expected, whole, found.records);
    if (!what.empty()) found.damage.push_back(what);
    return what.empty();
  };
  if (shard_is_there(folder, shard)) found.complete = take(file_of(folder, shard), true);
  found.parts = parts_of(folder, shard);
  for (const fs::path& part : found.parts) {
    try {
      (void)take(part, false);
    } catch (const FileError&) {
      // Another worker has completed the shard and removed this part.
    }
  }
  return found;
}

/// Draws with at least one missing record.
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

/// Makes the last rename durable, even after a power failure.
void sync_folder(const fs::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) fail(folder);
  const bool synced = ::fsync(file) == 0 || errno == EINVAL;
  const int reason = errno;
  ::close(file);
  errno = reason;
  if (!synced) fail(folder);
}

/// Writes the shard's file atomically, then removes the parts, which are no longer needed.
void finish(const CampaignFolder& folder, std::uint32_t shard, const RecordHeader& header,
            const Records& records) {
  std::string bytes;
  bytes.reserve(kRecordHeaderSize + records.size() * kRecordSize);
  internal::append(header, bytes);
  for (const auto& [number, record] : records) internal::append(record, bytes);
  Writer writer = open_part(folder, shard);
  writer.write_or_remove(bytes, /*synced=*/true);
  const fs::path file = file_of(folder, shard);
  if (::rename(writer.path().c_str(), file.c_str()) != 0) {
    // Another worker that completed the shard may have removed the part.
    const int reason = errno;
    Records other;
    if (reason != ENOENT || !shard_is_there(folder, shard) ||
        !take_file(file, header, true, other).empty())
      throw FileError(writer.path().string(), std::strerror(reason));
  }
  sync_folder(folder.path);
  std::error_code ignored;
  for (const fs::path& part : parts_of(folder, shard)) fs::remove(part, ignored);
}

}  // namespace

ShardState shard_state(const CampaignFolder& folder, std::uint32_t shard) {
  ShardState state;
  state.expected = header_of(folder, shard).count;
  Found found = find_records(folder, shard);
  state.complete = found.complete;
  state.records = found.records.size();
  state.damage = std::move(found.damage);
  state.workers = static_cast<int>(found.parts.size());
  for (const fs::path& part : found.parts) {
    std::error_code gone;
    const auto time = fs::last_write_time(part, gone);
    if (gone) continue;
    const double ago =
        std::chrono::duration<double>(fs::file_time_type::clock::now() - time).count();
    if (state.last_written >= 0 && ago >= state.last_written) continue;
    state.last_written = std::max(ago, 0.0);
    state.rate = rate_of(part, time);
  }
  return state;
}

bool shard_is_there(const CampaignFolder& folder, std::uint32_t shard) {
  std::error_code ignored;  // an error is reported when the file is read
  return fs::symlink_status(file_of(folder, shard), ignored).type() != fs::file_type::not_found;
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
  Found found = find_records(folder, shard);
  Records& records = found.records;
  work.damage = std::move(found.damage);
  work.found = records.size();
  if (found.complete && found.parts.empty()) {
    work.was_complete = true;
    return work;
  }
  const std::vector<std::uint32_t> missing = missing_draws(header, folder.cases, records);
  if (!missing.empty()) {
    Writer part = open_part(folder, shard);
    std::string bytes;
    internal::append(header, bytes);
    part.write_or_remove(bytes, /*synced=*/false);
    // A worker that completes the shard removes all parts.
    const auto lost = [&] { return !part.is_in_place() && !shard_is_there(folder, shard); };
    const auto stop = [&] { return (interrupted && interrupted()) || lost(); };
    for (std::size_t i = 0; i < missing.size();) {
      // As many consecutive draws as possible.
      std::size_t end = i + 1;
      while (end < missing.size() && end - i < kDrawsAtOnce && missing[end] == missing[end - 1] + 1)
        ++end;
      std::vector<CampaignRecord> flown;
      try {
        flown = fly_draws(campaign, missing[i], missing[end - 1] + 1, threads, stop);
      } catch (const Interrupted&) {
        if (lost())
          throw FileError(part.path().string(),
                          "was removed, alone or with its folder, while its flights were "
                          "simulated, but it must "
                          "exist until the shard is complete; its records are lost");
        throw;
      }
      part.write(bytes_of(flown));
      for (const CampaignRecord& record : flown)
        if (records.emplace(record.number, record).second) ++work.flown;
      i = end;
      if (progress) progress(work.flown, header.count - records.size());
    }
  }
  finish(folder, shard, header, records);
  return work;
}

}  // namespace quadtune
