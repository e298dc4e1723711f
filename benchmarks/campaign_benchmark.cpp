// SPDX-License-Identifier: Apache-2.0
// Measures the speed of campaigns, the speedup by a second worker, and the time to merge a million
// flights. docs/benchmarks.md describes what is timed.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "machine.hpp"
#include "plants/designed_mambo.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/uncertainty_reader.hpp"
#include "quadtune/simulation/campaign/campaign.hpp"
#include "quadtune/simulation/campaign/campaign_shard.hpp"
#include "quadtune/simulation/campaign/campaign_statistics.hpp"
#include "quadtune/simulation/campaign/campaign_table.hpp"
#include "simulation/campaign/campaign_records.hpp"
#include "temporary_directory.hpp"
#include "wall_time.hpp"

namespace quadtune::bench {
namespace {

namespace fs = std::filesystem;

constexpr char kFile[] = QUADTUNE_SOURCE_DIR "/campaigns/mambo-hover.toml";

/// Hovers of the Mambo with its sensors and its estimator; the parameters that
/// campaigns/mambo-hover.toml varies are drawn for each.
Campaign hovers(std::uint32_t flights, double duration) {
  CampaignCase designed;
  designed.design = "designed";
  designed.mission = "hover";
  FlightSetup& setup = designed.setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("hover");
  setup.controller = testing::designed_mambo_cascade();
  setup.duration = duration;
  calibrate_flow(setup);
  Campaign campaign;
  campaign.cases = {designed};
  campaign.uncertainty = internal::read_uncertainty(
      internal::TomlTable::parse(internal::read_text_file(kFile, internal::kTomlLimit), kFile),
      fs::path(kFile).parent_path());
  campaign.flights = flights;
  return campaign;
}

CampaignFolder folder_of(const fs::path& path, const Campaign& campaign, std::uint32_t shards) {
  return {path, std::string(64, 'a'), campaign.flights,
          static_cast<std::uint32_t>(campaign.cases.size()), shards};
}

bool same(const CampaignRecord& a, const CampaignRecord& b) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  bool equal = a.number == b.number && a.end == b.end && a.passed == b.passed &&
               a.reason == b.reason && bits(a.end_time) == bits(b.end_time);
  for (std::size_t m = 0; m < kMetrics; ++m)
    equal = equal && bits(a.metrics.value[m]) == bits(b.metrics.value[m]);
  return equal;
}

const char* verdict(bool met) { return met ? "met" : "not met"; }

void print_header() { fmt::print("\n| what | figure | goal | results |\n|---|---:|---|---|\n"); }

// --- flying ---

void fly_many() {
  constexpr std::uint32_t kFlights = 10000;
  constexpr double kDuration = 20, kGoal = 300;
  constexpr int kSample = 50;
  const Campaign campaign = hovers(kFlights, kDuration);
  const testing::TemporaryDirectory place;
  const CampaignFolder folder = folder_of(place.path(), campaign, 1);
  const Wall wall = wall_of([&] { (void)fly_shard(campaign, folder, 0, 2); }, 1);
  const std::vector<CampaignRecord> records = read_shard(folder, 0);
  std::mt19937_64 random(1);
  int equal = 0;
  std::uint64_t passed = 0;
  for (const CampaignRecord& record : records) passed += record.passed ? 1 : 0;
  for (int i = 0; i < kSample; ++i) {
    const std::uint64_t number = random() % records.size();
    const FlightSetup setup = setup_of(campaign, number);
    if (same(records[number], record_of(number, setup, fly(setup)))) ++equal;
  }
  const double rate = kFlights / wall.median;
  fmt::print(
      "| {} hovers of {:.0f} s, 2 threads: flights a second | {:.0f} | {:.0f}: {} | {} passed; {} "
      "of {} drawn at random are those flown alone |\n",
      kFlights, kDuration, rate, kGoal, verdict(rate >= kGoal), passed, equal, kSample);
}

/// Runs work in separate processes, and waits until all have ended.
/// @return  maximum memory of one of them [bytes]
std::uint64_t in_processes(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::fflush(stdout);
  std::vector<pid_t> children;
  for (std::size_t i = 0; i < count; ++i) {
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) {
      try {
        work(i);
      } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        _exit(1);
      }
      std::fflush(stdout);
      _exit(0);
    }
    children.push_back(child);
  }
  std::uint64_t max = 0;
  bool failed = false;
  for (const pid_t child : children) {
    int status = 0;
    rusage used{};
    failed = failed || wait4(child, &status, 0, &used) != child || status != 0;
    max = std::max(max, static_cast<std::uint64_t>(used.ru_maxrss) * 1024);
  }
  if (failed) throw std::runtime_error("a worker failed");
  return max;
}

/// Times one worker with one thread, then two in parallel on separate shards, several times in
/// turn. The ratio is that of the least times: other load on either processor delays the two, and
/// on one of them only the one.
void fly_in_processes() {
  constexpr std::uint32_t kFlights = 2 * 2048;
  constexpr double kGoal = 1.9;
  constexpr int kTimes = 10;
  const Campaign campaign = hovers(kFlights, 20);
  double least_single = std::numeric_limits<double>::infinity(),
         least_both = std::numeric_limits<double>::infinity();
  bool equal = true;
  for (int i = 0; i < kTimes; ++i) {
    const testing::TemporaryDirectory one, two;
    const Wall single = wall_of(
        [&] {
          (void)in_processes(1, [&](std::size_t) {
            (void)fly_shard(campaign, folder_of(one.path(), campaign, 2), 0, 1);
          });
        },
        1);
    const CampaignFolder folder = folder_of(two.path(), campaign, 2);
    const Wall both = wall_of(
        [&] {
          (void)in_processes(2, [&](std::size_t shard) {
            (void)fly_shard(campaign, folder, static_cast<std::uint32_t>(shard), 1);
          });
        },
        1);
    least_single = std::min(least_single, single.min);
    least_both = std::min(least_both, both.min);
    if (i > 0) continue;
    // The second shard again, in this process.
    const DrawRange draws = shard_draws(kFlights, 2, 1);
    const std::vector<CampaignRecord> flown = read_shard(folder, 1),
                                      here = fly_draws(campaign, draws.begin, draws.end, 2);
    equal = flown.size() == here.size() && one.read("00000.flights") == two.read("00000.flights");
    for (std::size_t k = 0; equal && k < here.size(); ++k) equal = same(flown[k], here[k]);
  }
  const double ratio = 2 * least_single / least_both;
  fmt::print(
      "| two workers of one thread over one of {:.0f} flights a second | {:.2f} times | {:.1f}: {} "
      "| {} |\n",
      0.5 * kFlights / least_single, ratio, kGoal, verdict(ratio >= kGoal),
      equal ? "the same bytes" : "NOT the same bytes");
}

// --- merging ---

constexpr std::uint32_t kDraws = 500000, kShards = 20;
constexpr std::uint64_t kRecords = 2 * std::uint64_t{kDraws};

/// campaigns/mambo-hover.toml.
Campaign both_designs(std::uint32_t flights) {
  Campaign campaign = hovers(flights, 20);
  campaign.cases.push_back(campaign.cases.front());
  CampaignCase& published = campaign.cases.back();
  published.design = "published";
  published.setup.controller = CascadeController{published.setup.vehicle.published_cascade->gains};
  return campaign;
}

/// Shards of synthetic flights: ends and missing metrics like those of real ones, other numbers
/// random.
void make_up(const fs::path& folder, const std::string& plan) {
  const std::vector<CampaignRecord> real = fly_draws(both_designs(512), 0, 512, 2);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (std::uint32_t shard = 0; shard < kShards; ++shard) {
    const DrawRange draws = shard_draws(kDraws, kShards, shard);
    const std::uint64_t first = 2 * std::uint64_t{draws.begin}, end = 2 * std::uint64_t{draws.end};
    std::string bytes;
    internal::append({plan.substr(0, 24), shard, kShards, first, end - first}, bytes);
    for (std::uint64_t number = first; number < end; ++number) {
      CampaignRecord record = real[random() % (real.size() / 2) * 2 + number % 2];
      record.number = number;
      for (double& value : record.metrics.value) value *= std::exp(0.1 * normal(random));
      internal::append(record, bytes);
    }
    std::FILE* file = std::fopen((folder / fmt::format("{:05}.flights", shard)).c_str(), "wb");
    const bool written = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    if (!file || std::fclose(file) != 0 || !written)
      throw std::runtime_error("simulated flights cannot be written");
  }
}

void run(const std::string& command) {
  if (std::system((command + " > /dev/null").c_str()) != 0)
    throw std::runtime_error(command + " failed");
}

std::uint64_t lines_of(const fs::path& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return 0;
  std::vector<char> block(1 << 20);
  std::uint64_t lines = 0;
  for (std::size_t size = 0; (size = std::fread(block.data(), 1, block.size(), file)) > 0;)
    lines += static_cast<std::uint64_t>(
        std::count(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(size), '\n'));
  (void)std::fclose(file);
  return lines;
}

/// Times the stages of a merge by the library, in a separate process.
void time_stages(const fs::path& path, const std::string& plan) {
  const Campaign campaign = both_designs(kDraws);
  std::vector<CampaignRecord> records;
  records.reserve(kRecords);
  const Wall read = wall_of(
      [&] {
        for (std::uint32_t shard = 0; shard < kShards; ++shard)
          for (CampaignRecord& record : read_shard({path, plan, kDraws, 2, kShards}, shard))
            records.push_back(std::move(record));
      },
      1);
  Eigen::MatrixXd drawn;
  const Wall draws = wall_of([&] { drawn = all_draws(campaign, 2); }, 1);
  CampaignStatistics statistics;
  const Wall summed =
      wall_of([&] { statistics = campaign_statistics(campaign, drawn, records, 2); }, 1);
  const Wall csv =
      wall_of([&] { write_campaign_csv(path / "stage.csv", campaign, drawn, records); }, 1);
  const Wall database =
      wall_of([&] { write_campaign_database(path / "stage.sqlite", campaign, drawn, records); }, 1);
  fmt::print(
      "\nof it: shards read {:.2f} s; drawn again {:.2f} s and statistics {:.2f} s on 2 threads; "
      "flights.csv {:.2f} s, campaign.sqlite {:.2f} s\n",
      read.median, draws.median, summed.median, csv.median, database.median);
}

void merge_a_million() {
  constexpr double kGoal = 10;
  const testing::TemporaryDirectory place;
  std::string text = internal::read_text_file(kFile, internal::kTomlLimit);
  const std::string flights = "flights = 200";
  text.replace(text.find(flights), flights.size(), fmt::format("flights = {}", kDraws));
  const std::string file = place.write("campaign.toml", text).string();
  const fs::path folder = place.path() / "out";
  run(fmt::format("{} campaign init {} {} --shards {}", QUADTUNE_PROGRAM, file, folder.string(),
                  kShards));
  const std::string plan = place.read("out/plan.sha256").substr(0, 64);
  make_up(folder, plan);
  std::uint64_t memory = 0;
  const Wall wall = wall_of(
      [&] {
        memory = in_processes(1, [&](std::size_t) {
          if (std::freopen("/dev/null", "w", stdout) != nullptr)
            execl(QUADTUNE_PROGRAM, QUADTUNE_PROGRAM, "campaign", "merge", folder.c_str(),
                  static_cast<char*>(nullptr));
          throw std::runtime_error("the program cannot be run");
        });
      },
      1);
  const auto size = [&](const char* name) {
    return static_cast<double>(fs::file_size(folder / name)) / 1e6;
  };
  const bool whole = lines_of(folder / "flights.csv") == kRecords + 1;
  fmt::print(
      "| merge of a million flights, 8 quantities, {} shards of {:.0f} MB: seconds | {:.1f} | "
      "{:.0f}: {} | {}; flights.csv {:.0f} MB, campaign.sqlite {:.0f} MB; at most {:.0f} MiB of "
      "memory |\n",
      kShards, size("00000.flights"), wall.median, kGoal, verdict(wall.median <= kGoal),
      whole ? "a row each" : "NOT a row each", size("flights.csv"), size("campaign.sqlite"),
      static_cast<double>(memory) / (1 << 20));
  (void)in_processes(1, [&](std::size_t) { time_stages(folder, plan); });
}

void measure() {
  fmt::print("{}", describe_machine());
  print_header();
  fly_many();
  fly_in_processes();
  merge_a_million();
}

}  // namespace
}  // namespace quadtune::bench

int main(int argc, char** argv) {
  // ./dev bench passes the options of Google Benchmark to every program; this one does not use it.
  for (const std::string_view option : std::span(argv, static_cast<std::size_t>(argc)).subspan(1))
    if (option.starts_with("--benchmark_filter=") && option.find("campaign") == option.npos)
      return 0;
  try {
    quadtune::bench::measure();
  } catch (const std::exception& error) {
    std::fputs(error.what(), stderr);
    return 1;
  }
}
