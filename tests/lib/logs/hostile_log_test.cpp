// SPDX-License-Identifier: Apache-2.0
/// Torn and damaged logs: an error in one line, or what can be read of them.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "log_files/hostile_samples.hpp"
#include "log_files/read_logs.hpp"
#include "logs/mat/mat_content.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/log_survey.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using testing::LogSample;
using testing::read_bytes;
using testing::WholeGroup;
using testing::WholeLog;

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same_row(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

// Every row of the part is the row of the whole in that place.
void expect_prefix(const WholeLog& part, const WholeLog& whole) {
  ASSERT_LE(part.groups.size(), whole.groups.size());
  for (std::size_t i = 0; i < part.groups.size(); ++i) {
    const WholeGroup& a = part.groups[i];
    const WholeGroup& b = whole.groups[i];
    ASSERT_EQ(a.group.name, b.group.name);
    ASSERT_LE(a.rows.size(), b.rows.size());
    ASSERT_TRUE(std::equal(a.time.begin(), a.time.end(), b.time.begin(), same));
    ASSERT_TRUE(std::equal(a.rows.begin(), a.rows.end(), b.rows.begin(), same_row));
  }
}

LogOptions options_of(const LogSample& sample) {
  LogOptions options;
  options.format = sample.format;
  return options;
}

// What came of reading; nothing where it was refused in one line.
std::optional<WholeLog> read_or_refuse(const std::string& bytes, const LogOptions& options) {
  try {
    return read_bytes(bytes, options);
  } catch (const InvalidInput& refusal) {
    const std::string what = refusal.what();
    EXPECT_NE(what, "");
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return std::nullopt;
  }
}

void expect_every_prefix_is_read_or_refused(const LogSample& sample) {
  const LogOptions options = options_of(sample);
  const WholeLog whole = read_bytes(sample.bytes, options);
  ASSERT_EQ(whole.condition.torn, "");
  for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
    SCOPED_TRACE(sample.name + " cut to " + std::to_string(size));
    const std::optional<WholeLog> part = read_or_refuse(sample.bytes.substr(0, size), options);
    if (!part) continue;
    expect_prefix(*part, whole);
    if (::testing::Test::HasFatalFailure()) return;
    // A cut between two records cannot be seen, any other one must be.
    const bool between =
        std::find(sample.borders.begin(), sample.borders.end(), size) != sample.borders.end();
    EXPECT_EQ(part->condition.torn.empty(), between) << part->condition.torn;
  }
}

TEST(HostileLogs, EveryPrefixIsReadOrRefused) {
  for (const LogSample& sample : testing::log_samples())
    expect_every_prefix_is_read_or_refused(sample);
}

// Each prefix of a MAT file is decoded in this process, where the sanitizers see it.
TEST(HostileLogs, EveryPrefixOfAMatFileIsReadOrRefused) {
  for (const LogSample& sample : testing::mat_samples())
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      const std::string bytes = sample.bytes.substr(0, size);
      internal::ByteStream stream(bytes, "f.mat");
      try {
        const internal::MatContent part = internal::decode_mat(stream, 1U << 24U);
        const bool between =
            std::find(sample.borders.begin(), sample.borders.end(), size) != sample.borders.end();
        EXPECT_EQ(part.condition.torn.empty(), between) << sample.name << " cut to " << size;
      } catch (const InvalidInput& refusal) {
        EXPECT_EQ(std::string(refusal.what()).find('\n'), std::string::npos);
      }
    }
}

std::string damaged(std::string bytes, std::mt19937_64& random) {
  for (std::uint64_t flips = 1 + random() % 8; flips > 0 && !bytes.empty(); --flips) {
    const std::size_t at = random() % bytes.size();
    const auto bit = static_cast<char>(1U << random() % 8);
    bytes[at] =
        random() % 2 == 0 ? static_cast<char>(bytes[at] ^ bit) : static_cast<char>(random());
  }
  return bytes;
}

TEST(HostileLogs, DamagedBytesAreReadOrRefused) {
  std::mt19937_64 random(7);
  for (const LogSample& sample : testing::log_samples())
    for (int round = 0; round < 2000; ++round) {
      const std::string bytes = damaged(sample.bytes, random);
      (void)read_or_refuse(bytes, options_of(sample));
      (void)read_or_refuse(bytes, {});  // whatever it looks like now
    }
}

TEST(HostileLogs, DamagedMatFilesAreReadOrRefused) {
  std::mt19937_64 random(8);
  LogOptions options;
  options.format = "mat";
  for (const LogSample& sample : testing::mat_samples())
    for (int round = 0; round < 2000; ++round)
      (void)read_or_refuse(damaged(sample.bytes, random), options);
}

std::string first_bytes(const std::filesystem::path& file, std::size_t size) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

TEST(HostileLogs, EveryPrefixOfRealLogsIsReadOrRefused) {
  QUADTUNE_REQUIRE_DATA(data);
  for (const char* file : {"mambo/flight_A.csv", "known/nile.csv", "euroc/V1_01_easy_imu0.csv",
                           "euroc/V1_01_easy_gt_20Hz.csv", "px4/replay_data__iris_gps.csv",
                           "px4/change_indication__iris_gps.csv", "uquad/imu_raw_static_20.txt",
                           "uquad2/log_test_IMU_3.txt", "uquad2/log_PD_nuevo_1.txt"}) {
    std::string bytes = first_bytes(data / file, 4096);
    bytes.resize(bytes.rfind('\n') + 1);
    LogSample sample{file, "", bytes, {}};
    for (std::size_t i = 0; i < bytes.size(); ++i)
      if (bytes[i] == '\n') sample.borders.push_back(i + 1);
    expect_every_prefix_is_read_or_refused(sample);
  }
}

TEST(HostileLogs, RealMatFilesCutAnywhere) {
  QUADTUNE_REQUIRE_DATA(data);
  const std::string bytes = first_bytes(data / "mambo/flight_A.mat", std::size_t{1} << 20U);
  LogOptions options;
  options.format = "mat";
  const WholeLog whole = read_bytes(bytes, options);
  for (std::size_t size = 0; size < bytes.size(); size += 9973) {
    const std::optional<WholeLog> part = read_or_refuse(bytes.substr(0, size), options);
    if (part) {
      EXPECT_NE(part->condition.torn, "") << size;
      EXPECT_LE(part->groups.size(), whole.groups.size());
    }
  }
}

}  // namespace
}  // namespace quadtune
