// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "quadtune/errors.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/campaign/campaign_scripts.hpp"
#include "quadtune/workbench/flight/sensor_bound.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using internal::Json;

constexpr std::size_t kLimit = std::size_t{1} << 30;

/// Whether a file exists; an error if this cannot be determined.
bool is_there(const fs::path& path) {
  std::error_code error;
  const bool there = fs::exists(path, error);
  if (error) throw FileError(path.string(), error.message());
  return there;
}

/// Describes the first key in which the plan in a folder differs from the requested one: ": what
/// differs is shards, 8 there and 1 here".
constexpr char kNewFolder[] = "; use a new folder for this one";

std::string difference_of(const fs::path& plan, const std::vector<FileContent>& files) {
  const auto asked = std::find_if(files.begin(), files.end(),
                                  [](const FileContent& file) { return file.name == kPlanName; });
  Json there;
  try {
    there = Json::parse(internal::read_file(plan.string(), kLimit));
  } catch (const internal::JsonError&) {
    return kNewFolder;
  }
  if (!there.is_object()) return kNewFolder;
  const Json here = Json::parse(asked->bytes);
  for (const std::string& key : here.keys()) {
    const Json& value = here[key];
    if (there.contains(key) && there[key] == value) continue;
    if (key == "shards" && there.contains(key)) {
      const std::string number = internal::json_text(there[key]);
      return fmt::format(
          ": its number of shards is {} and not {}; expected --shards {}, which continues it, or a "
          "new folder",
          number, internal::json_text(value), number);
    }
    const bool numbers = there.contains(key) && there[key].is_primitive();
    return numbers ? fmt::format(": {} is {} in the folder and {} in the request{}", key,
                                 internal::json_text(there[key]), internal::json_text(value),
                                 kNewFolder)
                   : fmt::format(": {} differs{}", key, kNewFolder);
  }
  return kNewFolder;
}

/// "done", "running", "stopped", "damaged" or "waiting".
std::string word_of(const ShardState& state) {
  constexpr double kAlive = 60;  // [s] since a worker wrote
  if (state.complete) return "done";
  if (state.workers > 0 && state.last_written < kAlive) return "running";
  if (!state.damage.empty()) return "damaged";
  return state.workers > 0 ? "stopped" : "waiting";
}

/// Rejects a folder with another plan.
void require_same(const fs::path& folder, const std::vector<FileContent>& files) {
  const fs::path plan = folder / kPlanName;
  for (const FileContent& content : files) {
    const fs::path path = folder / content.name;
    if (!is_there(path) || internal::read_file(path.string(), kLimit) != content.bytes)
      throw InvalidInput(plan.string(), "belongs to another plan" + difference_of(plan, files));
  }
}

void make_executable(const fs::path& path) {
  std::error_code error;
  fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                  fs::perm_options::add, error);
  if (error) throw FileError(path.string(), error.message());
}

}  // namespace

bool write_campaign(const MadeCampaign& made, const std::string& folder,
                    const std::function<bool()>& stop) {
  if (is_there(fs::path(folder) / kPlanName)) {
    require_same(folder, made.files);
    return true;
  }
  const std::vector<FileContent> scripts =
      campaign_scripts(made.plan, fs::absolute(folder).lexically_normal());
  // The plan is written last, so that a folder with a plan is complete.
  write_files(folder, scripts, {}, stop);
  for (const FileContent& script : scripts) make_executable(fs::path(folder) / script.name);
  write_files(folder, made.files, {}, stop);
  return false;
}

CampaignStatus campaign_status(const CampaignPlan& plan, const std::string& path) {
  const CampaignFolder folder = folder_of(plan, path);
  CampaignStatus status;
  status.expected = plan.campaign.records();
  double rate = 0;  // of the workers with a known rate
  int running = 0;
  for (std::uint32_t shard = 0; shard < plan.shards; ++shard) {
    const ShardState state = shard_state(folder, shard);
    const std::string word = word_of(state);
    status.records += state.records;
    if (word == "running") {
      ++running;
      rate += state.rate;
      status.known_workers += static_cast<int>(state.rate > 0);
    }
    status.shards.push_back({word, state.records, state.expected, state.damage});
  }
  if (status.records < status.expected)
    status.left = static_cast<double>(status.expected - status.records) * status.known_workers /
                  (rate * running);
  return status;
}

std::vector<CampaignRecord> all_records(const CampaignPlan& plan, const std::string& path,
                                        const std::function<bool()>& stop) {
  const CampaignFolder folder = folder_of(plan, path);
  std::vector<CampaignRecord> records;
  records.reserve(plan.campaign.records());
  std::vector<std::string> missing;
  for (std::uint32_t shard = 0; shard < plan.shards; ++shard) {
    if (stop && stop()) throw Interrupted();
    if (!shard_is_there(folder, shard)) {
      missing.push_back(fmt::format("{}", shard));
      continue;
    }
    for (CampaignRecord& record : read_shard(folder, shard)) records.push_back(std::move(record));
  }
  if (!missing.empty()) {
    constexpr std::size_t kNamed = 10;
    const std::size_t more = missing.size() > kNamed ? missing.size() - kNamed : 0;
    const std::string first = missing.front();
    missing.resize(missing.size() - more);
    throw InvalidInput(
        path, fmt::format("shard{} {}{} {} not complete; expected all {}: `quadtune campaign work "
                          "{} --shard {}` completes {}",
                          missing.size() + more == 1 ? "" : "s", internal::joined(missing, ", "),
                          more > 0 ? fmt::format(" and {} more", more) : "",
                          missing.size() + more == 1 ? "is" : "are", plan.shards, path, first,
                          missing.size() + more == 1 ? "it" : "the first"));
  }
  return records;
}

std::set<std::uint64_t> kept_flights(const CampaignPlan& plan,
                                     const std::vector<CampaignRecord>& records) {
  std::set<std::uint64_t> kept;
  int failures = 0;
  for (const CampaignRecord& record : records) {
    if (failures == plan.keep.failures) break;
    if (record.passed) continue;
    kept.insert(record.number);
    ++failures;
  }
  const auto sample = static_cast<std::uint64_t>(plan.keep.sample);
  for (std::uint64_t i = 0; i < sample; ++i) kept.insert(i * records.size() / sample);
  return kept;
}

PlannedFlight replayed_flight(const CampaignPlan& plan, std::uint64_t number) {
  const std::size_t which = number % plan.campaign.cases.size();
  PlannedFlight flight = plan.words[which];
  // Computed here and not in load_plan(), because workers do not need it.
  flight.bound = mission_bound(plan.campaign.cases[which].setup);
  flight.setup = setup_of(plan.campaign, number);
  return flight;
}

}  // namespace quadtune
