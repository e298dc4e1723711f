// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "log_files/read_logs.hpp"
#include "log_files/ulog_writer.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::packed;
using testing::read_bytes;
using ::testing::ThrowsMessage;
using testing::UlogWriter;
using testing::WholeGroup;
using testing::WholeLog;

// One topic "a" of a time and a float, under the number 0.
UlogWriter small() {
  UlogWriter log;
  log.format("a:uint64_t timestamp;float x;").subscribe(0, 0, "a");
  return log;
}
std::string row(std::uint64_t t, float x) { return packed(t, x); }

TEST(Ulog, UnfoldsTopicsIntoChannels) {
  const WholeLog log = read_bytes(testing::sample_ulog().bytes());
  EXPECT_EQ(log.format, "ulog");
  const WholeGroup& sensor = log.group("sensor");
  EXPECT_THAT(sensor.names(), ElementsAre("gyro[0].x", "gyro[0].y", "gyro[1].x", "gyro[1].y",
                                          "counts[0]", "counts[1]", "counts[2]"));
  EXPECT_EQ(sensor.time.size(), 10U);
  EXPECT_DOUBLE_EQ(sensor.time[3], 0.53);
  EXPECT_THAT(sensor.rows[3], ElementsAre(3, -3, 6, 0.5, 3, -3, 7));
  EXPECT_EQ(log.group("sensor.1").rows[3][0], 103);
  EXPECT_THAT(log.group("status").names(),
              ElementsAre("armed"));  // texts and padding are no numbers
  EXPECT_THAT(log.group("status").column("armed"), ElementsAre(0, 0, 0, 1, 1));
  EXPECT_EQ(log.condition.dropouts, 1U);
  EXPECT_THAT(log.condition.dropout_s, DoubleNear(0.025, 1e-15));
  EXPECT_TRUE(log.condition.whole());
  // Blocks follow the file: sensor, sensor.1, status, sensor, …
  EXPECT_THAT(std::vector<std::size_t>(log.order.begin(), log.order.begin() + 6),
              ElementsAre(0, 1, 2, 0, 1, 0));
}

// A topic whose time was never set would make a log of half a minute one of 54 years.
TEST(Ulog, LeavesOutRecordsWhoseTimeWasNeverSet) {
  const std::uint64_t start = 1700000000000000;
  UlogWriter log = small();
  log.format("b:uint64_t timestamp;float x;").subscribe(0, 1, "b");
  log.data(1, row(0, 7)).data(0, row(0, 7));
  for (std::uint64_t k = 0; k < 10; ++k) log.data(0, row(start + 100000 * k, 1));
  log.data(0, row(0, 7)).data(1, row(start, 2));
  const WholeLog read = read_bytes(log.bytes());
  EXPECT_EQ(read.epoch_s, 1700000000);
  EXPECT_THAT(read.group("a").column("x"), ::testing::Each(1));
  EXPECT_EQ(read.group("a").time.size(), 10U);
  EXPECT_THAT(read.group("a").time.back(), DoubleNear(0.9, 1e-12));
  EXPECT_THAT(read.group("b").column("x"), ElementsAre(2));
  EXPECT_THAT(
      read.condition.notes,
      ElementsAre("3 records are at time 0 (clock not set) and left out, the first of 'b'"));
  // So it is where the clock counts from the start of the vehicle.
  UlogWriter since_boot = small();
  since_boot.data(0, row(600000000, 1)).data(0, row(0, 7)).data(0, row(600100000, 1));
  EXPECT_EQ(read_bytes(since_boot.bytes()).group("a").time.size(), 2U);
  // A log that begins at 0 does so in earnest.
  UlogWriter zero = small();
  for (std::uint64_t k = 0; k < 3; ++k) zero.data(0, row(2000000 * k, 1));
  EXPECT_EQ(read_bytes(zero.bytes()).group("a").time.size(), 3U);
  EXPECT_TRUE(read_bytes(zero.bytes()).condition.notes.empty());
}

TEST(Ulog, KnowsAllTypes) {
  UlogWriter log;
  log.format(
      "a:uint64_t timestamp;int8_t a;uint8_t b;int16_t c;uint16_t d;int32_t e;uint32_t f;"
      "int64_t g;uint64_t h;float i;double j;bool k;");
  log.subscribe(0, 9, "a");
  log.data(9, packed(std::uint64_t{1}, std::int8_t{-2}, std::uint8_t{200}, std::int16_t{-300},
                     std::uint16_t{60000}, std::int32_t{-70000}, std::uint32_t{4000000000},
                     std::int64_t{-5000000000}, std::uint64_t{1} << 63U, 0.5F, 0.1, true));
  EXPECT_THAT(
      read_bytes(log.bytes()).group("a").rows[0],
      ElementsAre(-2, 200, -300, 60000, -70000, 4e9, -5e9, 9223372036854775808.0, 0.5, 0.1, 1));
}

// The logger writes records without the padding at their end.
TEST(Ulog, PaddingAtTheEndMayBeAbsent) {
  UlogWriter log;
  log.format("a:uint64_t timestamp;uint8_t x;uint8_t[7] _padding0;").subscribe(0, 0, "a");
  log.data(0, packed(std::uint64_t{1}, std::uint8_t{5}));
  log.data(0, packed(std::uint64_t{2}, std::uint8_t{6}) + std::string(7, '\0'));
  log.data(0, packed(std::uint64_t{3}) + std::string(9, '\0'));
  const WholeLog read = read_bytes(log.bytes());
  EXPECT_THAT(read.group("a").column("x"), ElementsAre(5, 6));
  EXPECT_EQ(read.condition.skipped, 1U);
  EXPECT_THAT(read.condition.first_skipped, HasSubstr("a record of 17 bytes, expected 16"));
}

// After a crash the log is cut within a message, and the crash report is appended.
TEST(Ulog, ReadsWhatIsAppendedBehindACut) {
  UlogWriter log;
  log.flags().format("a:uint64_t timestamp;float x;").subscribe(0, 0, "a");
  log.data(0, row(1, 1));
  log.raw(packed(std::uint16_t{14}, 'D', std::uint16_t{0}) + "abc");
  log.append_here().data(0, row(2, 2));
  const WholeLog read = read_bytes(log.bytes());
  EXPECT_THAT(read.group("a").column("x"), ElementsAre(1, 2));
  EXPECT_EQ(read.condition.skipped, 1U);
  EXPECT_EQ(read.condition.torn, "");
}

TEST(Ulog, GoesOnBehindDamage) {
  UlogWriter log = small();
  log.data(0, row(1, 1));
  log.message('x', "of a later reader").data(0, row(2, 2));  // passed over by its length
  log.raw("\xff\xff\xff garbage without a length").sync();
  log.data(0, row(3, 3)).data(7, row(4, 4)).data(0, row(5, 5));
  const WholeLog read = read_bytes(log.bytes());
  EXPECT_THAT(read.group("a").column("x"), ElementsAre(1, 2, 3, 5));
  EXPECT_EQ(read.condition.skipped, 3U);
  EXPECT_THAT(read.condition.first_skipped, HasSubstr("a message of unknown type 0x78 at offset"));
}

TEST(Ulog, TopicsThatNoFormatDescribesArePassedOver) {
  UlogWriter log = small();
  log.format("loop:loop a;").format("noname").format("bad:float;").format("neg:float[0] x;");
  log.format("huge:uint64_t timestamp;uint64_t[9000] x;");
  log.format("deep:empty[65000] x;").format("empty:nothing[65000] x;").format("nothing:");
  for (const char* topic : {"loop", "missing", "huge", "deep"}) log.subscribe(0, 3, topic);
  log.data(3, row(1, 1)).data(0, row(1, 1));
  const WholeLog read = read_bytes(log.bytes());
  EXPECT_EQ(read.groups.size(), 1U);
  EXPECT_THAT(read.group("a").column("x"), ElementsAre(1));
  EXPECT_EQ(read.condition.skipped, 8U);
}

// Its rows would stand in the columns of the first ones.
TEST(Ulog, ATopicThatComesAgainWithOtherFieldsIsPassedOver) {
  for (const char* other : {"a:uint64_t timestamp;float y;", "a:float x;", "a:uint64_t timestamp;",
                            "a:uint64_t timestamp;float x;float y;"}) {
    UlogWriter log = small();
    log.data(0, row(1, 5)).format(other).subscribe(0, 1, "a").data(1, row(2, 6)).data(0, row(3, 7));
    const WholeLog read = read_bytes(log.bytes());
    EXPECT_THAT(read.group("a").column("x"), ElementsAre(5, 7)) << other;
    EXPECT_EQ(read.condition.skipped, 2U) << other;
    EXPECT_THAT(read.condition.first_skipped,
                HasSubstr("topic 'a' is subscribed again with different fields"))
        << other;
  }
  // With the same ones it goes on.
  UlogWriter log = small();
  log.data(0, row(1, 5)).subscribe(0, 1, "a").data(1, row(2, 6));
  EXPECT_THAT(read_bytes(log.bytes()).group("a").column("x"), ElementsAre(5, 6));
}

TEST(Ulog, RefusesWhatItDoesNotKnow) {
  UlogWriter later;
  later.message('B', std::string(8, '\0') + "\x02" + std::string(31, '\0'));
  EXPECT_THAT([&] { (void)read_bytes(later.bytes()); },
              ThrowsMessage<InvalidInput>(HasSubstr("a newer version of ULog")));
  EXPECT_THAT([&] { (void)read_bytes(later.bytes().substr(0, 10)); },
              ThrowsMessage<InvalidInput>(HasSubstr("no complete ULog header")));
  LogOptions options;
  options.format = "ulog";
  EXPECT_THAT([&] { (void)read_bytes("no", options); },
              ThrowsMessage<InvalidInput>(HasSubstr("does not begin like a ULog")));
}

TEST(Ulog, ATornMessageIsTheEnd) {
  UlogWriter log = small();
  log.data(0, row(1, 1)).data(0, row(2, 2));
  const WholeLog read = read_bytes(log.bytes().substr(0, log.bytes().size() - 1));
  EXPECT_THAT(read.group("a").column("x"), ElementsAre(1));
  EXPECT_THAT(read.condition.torn, HasSubstr("f.log: the file ends within a message at offset"));
}

}  // namespace
}  // namespace quadtune
