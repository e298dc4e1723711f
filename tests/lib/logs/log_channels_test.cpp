// SPDX-License-Identifier: Apache-2.0
#include "quadtune/logs/log_channels.hpp"

#include <gmock/gmock.h>

#include "log_files/ulog_writer.hpp"
#include "quadtune/errors.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

class LogChannelsTest : public ::testing::Test {
 protected:
  std::string file(const std::string& bytes) const {
    return folder_.write("f.log", bytes).string();
  }

  TemporaryDirectory folder_;
};

TEST_F(LogChannelsTest, AreReadByNameInTheOrderAskedFor) {
  const std::string path = file("t,z[m],w\n0,1,\n1,,2\n2,3,4\n");
  const LogChannels channels = read_log_channels(path, {"w", "z"});
  EXPECT_EQ(channels.series[1].unit, "m");
  EXPECT_THAT(channels.series[0].time, ElementsAre(1, 2));
  EXPECT_THAT(channels.series[0].values, ElementsAre(2, 4));
  EXPECT_THAT(channels.series[1].time, ElementsAre(0, 2));  // what has no value is left out
  EXPECT_THAT(channels.series[1].values, ElementsAre(1, 3));
}

TEST_F(LogChannelsTest, OfATextHaveNumbers) {
  const std::string path = file("t,z[m],w\n0,1,\n1,,2\n2,3,4\n");
  const LogChannels channels = read_log_channels(path, {"3", "2"});
  EXPECT_EQ(channels.series[0].name, "w");
  EXPECT_EQ(channels.series[1].name, "z");
  EXPECT_THAT(channels.series[1].values, ElementsAre(1, 3));
  EXPECT_THAT([&] { (void)read_log_channels(path, {"1"}); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no channel '1'")));  // the clock
}

TEST_F(LogChannelsTest, SomeMayBeAbsent) {
  const std::string path = file("t,z,w\n0,1,5\n1,3,4\n");
  const LogChannels channels = read_log_channels(path, {"w"}, {}, {"y", "z"});
  ASSERT_EQ(channels.series.size(), 3U);
  EXPECT_EQ(channels.series[1].name, "");
  EXPECT_TRUE(channels.series[1].values.empty());
  EXPECT_THAT(channels.series[2].values, ElementsAre(1, 3));
}

TEST_F(LogChannelsTest, WithoutTimeCountRows) {
  const LogChannels channels = read_log_channels(file("a,b\n1,\n,2\n3,4\n"), {"b"});
  EXPECT_FALSE(channels.series[0].timed);
  EXPECT_THAT(channels.series[0].time, ElementsAre(1, 2));
}

TEST_F(LogChannelsTest, AreFoundByShortAndFullNames) {
  const std::string path = file(testing::sample_ulog().bytes());
  const LogChannels channels = read_log_channels(path, {"armed", "sensor.1.gyro[0].x"});
  EXPECT_EQ(channels.series[0].name, "status.armed");
  EXPECT_EQ(channels.series[1].values[2], 102);
  EXPECT_EQ(channels.series[1].time.size(), 10U);
}

// Channel "b.x" of topic a is also the full name of channel x of topic b.
TEST_F(LogChannelsTest, AFullNameWinsOverAShortOne) {
  for (const bool full_first : {false, true}) {
    testing::UlogWriter log;
    log.format("v:float x;").format("a:uint64_t timestamp;v b;");
    log.format("b:uint64_t timestamp;float x;");
    log.subscribe(0, 0, full_first ? "b" : "a").subscribe(0, 1, full_first ? "a" : "b");
    log.data(0, testing::packed(std::uint64_t{1}, full_first ? 2.0F : 1.0F));
    log.data(1, testing::packed(std::uint64_t{2}, full_first ? 1.0F : 2.0F));
    const LogChannels channels = read_log_channels(file(log.bytes()), {"b.x", "a.b.x"});
    EXPECT_THAT(channels.series[0].values, ElementsAre(2));
    EXPECT_THAT(channels.series[1].values, ElementsAre(1));
  }
}

TEST_F(LogChannelsTest, UnknownNamesComeWithTheNearest) {
  const std::string path = file(testing::sample_ulog().bytes());
  EXPECT_THAT([&] { (void)read_log_channels(path, {"status.armd"}); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("has no channel 'status.armd'; did you mean 'status.armed'?")));
  EXPECT_THAT(
      [&] { (void)read_log_channels(path, {"counts[1]"}); },
      ThrowsMessage<InvalidInput>(HasSubstr("'counts[1]' is the name of several channels, expected "
                                            "one of sensor.counts[1] and sensor.1.counts[1]")));
  EXPECT_THAT([&] { (void)read_log_channels(file("t,z,w\n0,1,2\n"), {"u"}); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no channel 'u', expected one of z w")));
  EXPECT_THAT(
      [&] {
        (void)read_log_channels(file("t,z,w\n0,1,2\n"), {"u", "z", "v", "ww"});
      },
      ThrowsMessage<InvalidInput>(
          HasSubstr("has no channels 'u', 'v', 'ww', expected one of z w")));
}

TEST(LogSeriesChecks, RefuseWhatNoMethodCanUse) {
  LogSeries series{"z", "m", true, {0, 1, 1}, {5, 6, 7}};
  EXPECT_THAT([&] { require_usable(series, "f.csv"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("f.csv: the time of 'z' does not increase: sample 3 is at 1 s")));
  series.time = {0, 1, 2};
  EXPECT_NO_THROW(require_usable(series, "f.csv"));
  EXPECT_THAT([&] { require_usable(series, "f.csv", 4); },
              ThrowsMessage<InvalidInput>("f.csv: 'z' has 3 samples, expected 4 or more"));
  EXPECT_THAT(
      [&] {
        require_usable({"z", "m", true, {}, {}}, "f.csv");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("no row of it holds a number")));
  series.timed = false;
  EXPECT_THAT([&] { require_usable(series, "f.csv"); },
              ThrowsMessage<InvalidInput>(HasSubstr("'z' has no time")));
  EXPECT_NO_THROW(require_unit(series, "m", "f.csv"));
  EXPECT_THAT([&] { require_unit(series, "m/s", "f.csv"); },
              ThrowsMessage<InvalidInput>("f.csv: 'z' is in m, expected m/s"));
  series.unit = "rad s^-1";
  EXPECT_NO_THROW(require_unit(series, "rad/s", "f.csv"));
}

}  // namespace
}  // namespace quadtune
