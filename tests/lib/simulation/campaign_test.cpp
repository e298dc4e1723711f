// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/campaign.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <random>
#include <thread>
#include <utility>

#include "plants/designed_mambo.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/campaign/campaign_shard.hpp"
#include "same_bits.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::same_bits;
using ::testing::SizeIs;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

/// Short hovers of the Mambo with two laws; some with much wind.
Campaign small_campaign(std::uint32_t flights, double duration = 0.5) {
  CampaignCase designed;
  designed.design = "designed";
  designed.mission = "hover";
  FlightSetup& setup = designed.setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("hover");
  setup.controller = testing::designed_mambo_cascade();
  setup.duration = duration;
  calibrate_flow(setup);
  CampaignCase published = designed;
  published.design = "published";
  published.setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  Campaign campaign;
  campaign.cases = {designed, published};
  campaign.uncertainty.numbers = {{"mass", {DistributionKind::normal, 1, 0.05}},
                                  {"gyroscope_noise", {DistributionKind::log_normal, 1, 0.3}}};
  campaign.flights = flights;
  campaign.seed = 11;
  return campaign;
}

CampaignFolder folder_of(const TemporaryDirectory& directory, const Campaign& campaign,
                         std::uint32_t shards) {
  return {directory.path(), std::string(64, 'a'), campaign.flights,
          static_cast<std::uint32_t>(campaign.cases.size()), shards};
}

std::vector<CampaignRecord> all_records(const CampaignFolder& folder) {
  std::vector<CampaignRecord> all;
  for (std::uint32_t shard = 0; shard < folder.shards; ++shard)
    for (CampaignRecord& record : read_shard(folder, shard)) all.push_back(std::move(record));
  return all;
}

void expect_same(const std::vector<CampaignRecord>& a, const std::vector<CampaignRecord>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].number, b[i].number);
    EXPECT_EQ(a[i].end, b[i].end);
    EXPECT_EQ(a[i].passed, b[i].passed);
    EXPECT_EQ(a[i].reason, b[i].reason);
    EXPECT_TRUE(same_bits(a[i].end_time, b[i].end_time));
    for (std::size_t m = 0; m < kMetrics; ++m)
      EXPECT_TRUE(same_bits(a[i].metrics.value[m], b[i].metrics.value[m])) << i << " " << m;
  }
}

TEST(Campaign, ShardsShareTheDrawsOut) {
  for (const std::uint32_t flights : {1u, 7u, 1000u, 4000000000u})
    for (const std::uint32_t shards : {1u, 3u, 64u}) {
      std::uint32_t at = 0;
      for (std::uint32_t k = 0; k < shards; ++k) {
        const DrawRange range = shard_draws(flights, shards, k);
        EXPECT_EQ(range.begin, at);
        EXPECT_LE(range.end - range.begin, flights / shards + 1);
        at = range.end;
      }
      EXPECT_EQ(at, flights);
    }
}

TEST(Campaign, AFlightIsTheSameInEverySplit) {
  const Campaign campaign = small_campaign(37);
  const std::vector<CampaignRecord> all = fly_draws(campaign, 0, 37, 2);
  std::vector<CampaignRecord> parts;
  for (const auto& [begin, end] : {std::pair(0u, 1u), {1u, 20u}, {20u, 37u}})
    for (CampaignRecord& record : fly_draws(campaign, begin, end, 1))
      parts.push_back(std::move(record));
  expect_same(all, parts);
  // And the same as alone.
  for (const std::uint64_t number : {0u, 1u, 40u, 73u}) {
    const FlightSetup setup = setup_of(campaign, number);
    expect_same({all[number]}, {record_of(number, setup, fly(setup))});
  }
}

TEST(Campaign, DesignsMeetTheSameDraws) {
  const Campaign campaign = small_campaign(5);
  const FlightSetup first = setup_of(campaign, 6), second = setup_of(campaign, 7);
  EXPECT_EQ(first.flown->mass, second.flown->mass);
  EXPECT_EQ(first.flight, second.flight);
  EXPECT_NE(first.flown->mass, setup_of(campaign, 8).flown->mass);
}

TEST(Campaign, AllDrawsAreThoseOfEachFlight) {
  const Campaign campaign = small_campaign(5000);
  const Eigen::MatrixXd all = all_draws(campaign, 3);
  ASSERT_EQ(all.rows(), 2);
  ASSERT_EQ(all.cols(), 5000);
  for (const std::uint32_t flight : {0u, 1u, 4095u, 4096u, 4999u})
    EXPECT_EQ(all.col(flight), draw(campaign.uncertainty, campaign.seed, flight)) << flight;
  EXPECT_EQ(all, all_draws(campaign, 1));
}

TEST(Campaign, AShardIsFlownOnceAndReadBackExactly) {
  const Campaign campaign = small_campaign(10);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 3);
  for (std::uint32_t shard = 0; shard < 3; ++shard) {
    EXPECT_FALSE(shard_state(folder, shard).complete);
    const ShardWork work = fly_shard(campaign, folder, shard, 1);
    EXPECT_FALSE(work.was_complete);
    EXPECT_EQ(work.flown, shard_state(folder, shard).expected);
    EXPECT_TRUE(shard_state(folder, shard).complete);
    EXPECT_TRUE(fly_shard(campaign, folder, shard, 1).was_complete);
  }
  expect_same(all_records(folder), fly_draws(campaign, 0, 10, 1));
  // Nothing but the three files is left.
  EXPECT_EQ(std::distance(fs::directory_iterator(directory.path()), {}), 3);
}

/// The checksum of zlib, bit by bit.
std::uint32_t crc_32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~crc;
}

// Byte by byte as docs/formats.md says, for those who read the files without quadtune.
TEST(Campaign, RecordsLieAsTheFormatSays) {
  const Campaign campaign = small_campaign(6);
  const TemporaryDirectory directory;
  CampaignFolder folder = folder_of(directory, campaign, 2);
  folder.plan = "0123456789abcdefghijklmn" + std::string(40, '-');
  (void)fly_shard(campaign, folder, 1, 1);
  const std::string bytes = directory.read("00001.flights");
  ASSERT_EQ(bytes.size(), 64 + 6 * 232);
  const auto at = [&]<class T>(std::size_t place, T value) {
    std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
  };
  constexpr std::uint16_t u16 = 0;
  constexpr std::uint32_t u32 = 0;
  constexpr std::uint64_t u64 = 0;
  EXPECT_EQ(at(0, u32), crc_32(bytes.substr(4, 60)));
  EXPECT_EQ(at(4, u32), 2);
  EXPECT_EQ(bytes.substr(8, 8), "qtflight");
  EXPECT_EQ(at(16, u32), 1);
  EXPECT_EQ(at(20, u32), 2);
  EXPECT_EQ(at(24, u64), 6);
  EXPECT_EQ(at(32, u64), 6);
  EXPECT_EQ(bytes.substr(40, 24), "0123456789abcdefghijklmn");
  const std::vector<CampaignRecord> records = read_shard(folder, 1);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const std::size_t begin = 64 + 232 * k;
    EXPECT_EQ(at(begin, u32), crc_32(bytes.substr(begin + 4, 228)));
    EXPECT_EQ(at(begin + 4, u16), static_cast<std::uint16_t>(records[k].end));
    EXPECT_EQ(at(begin + 6, u16), records[k].passed ? 1 : 0);
    EXPECT_EQ(at(begin + 8, u64), 6 + k);
    EXPECT_TRUE(same_bits(at(begin + 16, 0.0), records[k].end_time));
    ASSERT_EQ(kMetrics, 20);
    for (std::size_t m = 0; m < kMetrics; ++m)
      EXPECT_TRUE(same_bits(at(begin + 24 + 8 * m, 0.0), records[k].metrics.value[m]));
    EXPECT_EQ(bytes.substr(begin + 184, 48),
              records[k].reason + std::string(48 - records[k].reason.size(), '\0'));
  }
}

// Workers are killed at any time; their flights count once.
TEST(Campaign, KilledWorkersLoseNothing) {
  const Campaign campaign = small_campaign(6000, 0.2);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 2);
  std::mt19937 random(1);
  int killed = 0;
  while (killed < 30) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      (void)fly_shard(campaign, folder, static_cast<std::uint32_t>(killed % 2), 1);
      _exit(0);
    }
    std::this_thread::sleep_for(
        std::chrono::milliseconds(std::uniform_int_distribution(2, 40)(random)));
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    // One that was done first leaves the next one nothing to do.
    if (WIFSIGNALED(status))
      ++killed;
    else
      fs::remove(directory.path() / fmt::format("{:05}.flights", killed % 2));
  }
  std::uint64_t found = 0;
  for (std::uint32_t shard = 0; shard < 2; ++shard) {
    const ShardWork work = fly_shard(campaign, folder, shard, 1);
    found += work.found;
    EXPECT_THAT(work.damage, IsEmpty());
  }
  expect_same(all_records(folder), fly_draws(campaign, 0, 6000, 2));
  RecordProperty("records found again", std::to_string(found));
}

TEST(Campaign, DamageIsNamedAndFlownAgain) {
  const Campaign campaign = small_campaign(8);
  const std::vector<CampaignRecord> expected = fly_draws(campaign, 0, 8, 1);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  (void)fly_shard(campaign, folder, 0, 1);
  const std::string right = directory.read("00000.flights");
  constexpr std::size_t kRecord = 24 + 8 * kMetrics + 48;
  ASSERT_EQ(right.size(), 64 + 16 * kRecord);

  std::string flipped = right;
  flipped[64 + 4 * kRecord + 60] ^= 1;
  directory.write("00000.flights", flipped);
  EXPECT_FALSE(shard_state(folder, 0).complete);
  EXPECT_THAT(shard_state(folder, 0).damage,
              ElementsAre("00000.flights: record 5 of 16 is damaged (wrong checksum)"));
  EXPECT_THAT([&] { (void)read_shard(folder, 0); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("00000.flights: record 5 of 16 is damaged (wrong checksum); `campaign "
                            "work` with --shard 0 flies what is missing")));
  ShardWork work = fly_shard(campaign, folder, 0, 1);
  EXPECT_EQ(work.found, 15);
  EXPECT_EQ(work.flown, 1);
  EXPECT_THAT(work.damage, SizeIs(1));
  EXPECT_EQ(directory.read("00000.flights"), right);

  directory.write("00000.flights", right.substr(0, 64 + 3 * kRecord + 7));
  EXPECT_THAT(shard_state(folder, 0).damage,
              ElementsAre(fmt::format("00000.flights: it has {} bytes, expected {}",
                                      64 + 3 * kRecord + 7, right.size())));
  work = fly_shard(campaign, folder, 0, 1);
  EXPECT_EQ(work.found, 3);
  EXPECT_EQ(directory.read("00000.flights"), right);

  // A right record in another's place.
  directory.write("00000.flights", right.substr(0, 64 + 3 * kRecord) + right.substr(64, kRecord) +
                                       right.substr(64 + 4 * kRecord));
  EXPECT_THAT(shard_state(folder, 0).damage,
              ElementsAre("00000.flights: record 4 of 16 belongs to flight 0, expected another"));
  work = fly_shard(campaign, folder, 0, 1);
  EXPECT_EQ(work.found, 15);
  EXPECT_EQ(directory.read("00000.flights"), right);

  directory.write("00000.flights", right + right.substr(64, kRecord));
  EXPECT_THAT(shard_state(folder, 0).damage, SizeIs(1));
  work = fly_shard(campaign, folder, 0, 1);
  EXPECT_EQ(work.flown, 0);
  EXPECT_EQ(directory.read("00000.flights"), right);

  // Every byte of the head counts; without a head nothing is used.
  for (std::size_t i = 0; i < 64; i += 7) {
    std::string bad = right;
    bad[i] ^= 4;
    directory.write("00000.flights", bad);
    EXPECT_FALSE(shard_state(folder, 0).complete) << i;
  }
  work = fly_shard(campaign, folder, 0, 1);
  EXPECT_EQ(work.flown, 16);
  EXPECT_EQ(directory.read("00000.flights"), right);
  expect_same(all_records(folder), expected);
}

// A worker that is killed may leave any beginning of its part: none is damage, and each whole
// record counts.
TEST(Campaign, ABeginningOfAPartIsNoDamage) {
  const Campaign campaign = small_campaign(4);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  (void)fly_shard(campaign, folder, 0, 1);
  const std::string right = directory.read("00000.flights");
  fs::remove(directory.path() / "00000.flights");
  for (const std::size_t size : {0U, 10U, 64U, 70U, 64U + 2 * 232U, 64U + 2 * 232U + 231U}) {
    directory.write("00000.host-1-0.part", right.substr(0, size));
    const ShardState state = shard_state(folder, 0);
    EXPECT_THAT(state.damage, IsEmpty()) << size;
    EXPECT_EQ(state.records, size < 64 ? 0 : (size - 64) / 232) << size;
    EXPECT_EQ(state.workers, 1) << size;
    EXPECT_FALSE(state.complete) << size;
  }
  EXPECT_EQ(fly_shard(campaign, folder, 0, 1).found, 2);
  EXPECT_EQ(directory.read("00000.flights"), right);
}

TEST(Campaign, AFileThatCannotBeReadIsNotOneThatIsMissing) {
  const Campaign campaign = small_campaign(2);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  EXPECT_FALSE(shard_is_there(folder, 0));
  fs::create_directory(directory.path() / "00000.flights");
  EXPECT_TRUE(shard_is_there(folder, 0));
  EXPECT_THROW((void)shard_state(folder, 0), FileError);
  EXPECT_THROW((void)fly_shard(campaign, folder, 0, 1), FileError);
}

TEST(Campaign, AWorkerTellsWhatIsMissing) {
  const Campaign campaign = small_campaign(600, 0.2);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> told;
  const auto tell = [&](std::uint64_t flown, std::uint64_t missing) {
    told.emplace_back(flown, missing);
  };
  bool stop = false;
  EXPECT_THROW((void)fly_shard(
                   campaign, folder, 0, 1, [&](std::uint64_t, std::uint64_t) { stop = true; },
                   [&] { return stop; }),
               Interrupted);
  (void)fly_shard(campaign, folder, 0, 1, tell);
  EXPECT_THAT(told, ElementsAre(std::pair(512U, 176U), std::pair(688U, 0U)));
}

TEST(Campaign, RecordsOfAnotherPlanAreNotTaken) {
  const Campaign campaign = small_campaign(4);
  const TemporaryDirectory directory;
  CampaignFolder folder = folder_of(directory, campaign, 1);
  (void)fly_shard(campaign, folder, 0, 1);
  folder.plan = std::string(64, 'b');
  EXPECT_THAT([&] { (void)read_shard(folder, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("it belongs to another plan or shard")));
  const ShardWork work = fly_shard(campaign, folder, 0, 1);
  EXPECT_EQ(work.found, 0);
  EXPECT_EQ(work.flown, 8);
}

TEST(Campaign, TwoWorkersOnOneShardLeaveTheSameBytes) {
  const Campaign campaign = small_campaign(300, 0.3);
  const TemporaryDirectory directory, other;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  std::thread one([&] { (void)fly_shard(campaign, folder, 0, 1); });
  std::thread two([&] { (void)fly_shard(campaign, folder, 0, 1); });
  one.join();
  two.join();
  (void)fly_shard(campaign, folder_of(other, campaign, 1), 0, 2);
  EXPECT_EQ(directory.read("00000.flights"), other.read("00000.flights"));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory.path()), {}), 1);
}

TEST(Campaign, AnInterruptKeepsWhatWasFlown) {
  const Campaign campaign = small_campaign(600, 0.2);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  bool stop = false;
  EXPECT_THROW((void)fly_shard(
                   campaign, folder, 0, 1, [&](std::uint64_t, std::uint64_t) { stop = true; },
                   [&] { return stop; }),
               Interrupted);
  const ShardState state = shard_state(folder, 0);
  EXPECT_EQ(state.records, 512);
  EXPECT_EQ(state.workers, 1);
  EXPECT_GE(state.last_written, 0);
  EXPECT_EQ(fly_shard(campaign, folder, 0, 1).found, 512);
}

TEST(Campaign, RefusesWhatCannotBeFlown) {
  Campaign campaign = small_campaign(4);
  validate(campaign, "c.toml");
  campaign.flights = 0;
  EXPECT_THAT([&] { validate(campaign, "c.toml"); },
              ThrowsMessage<InvalidInput>(HasSubstr("c.toml: flights is 0, expected 1 or more")));
  campaign = small_campaign(4);
  campaign.uncertainty.numbers.push_back({"vision_noise", {DistributionKind::normal, 1, 0.1}});
  EXPECT_THAT([&] { validate(campaign, "c.toml"); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "c.toml: designed in hover: vision_noise: the file of the vehicle 'mambo'")));
  EXPECT_THAT([&] { (void)setup_of(small_campaign(4), 8); },
              ThrowsMessage<InvalidInput>(HasSubstr("flight: the number is 8, expected 0 to 7")));
}

// It flew on, for hours, and wrote into a file that nobody could find.
TEST(CampaignShards, AWorkerNoticesThatItsFolderIsGone) {
  const Campaign campaign = small_campaign(8);
  const TemporaryDirectory directory;
  CampaignFolder folder = folder_of(directory, campaign, 1);
  folder.path /= "flown";
  fs::create_directories(folder.path);
  const auto remove_it = [&] {
    fs::remove_all(folder.path);
    return false;
  };
  EXPECT_THAT([&] { (void)fly_shard(campaign, folder, 0, 1, {}, remove_it); },
              ThrowsMessage<FileError>(HasSubstr("was removed, alone or with its folder")));
  EXPECT_FALSE(fs::exists(folder.path));
}

// The worker that finished a shard first takes all parts away: nothing is lost.
TEST(CampaignShards, AWorkerWhosePartIsOfNoMoreUseIsNotLost) {
  const Campaign campaign = small_campaign(8);
  const TemporaryDirectory directory;
  const CampaignFolder folder = folder_of(directory, campaign, 1);
  bool flown = false;
  const auto be_faster = [&] {
    if (!std::exchange(flown, true)) (void)fly_shard(campaign, folder, 0, 1);
    return false;
  };
  (void)fly_shard(campaign, folder, 0, 1, {}, be_faster);
  EXPECT_TRUE(fly_shard(campaign, folder, 0, 1).was_complete);
}

}  // namespace
}  // namespace quadtune
