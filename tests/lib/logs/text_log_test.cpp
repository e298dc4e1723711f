// SPDX-License-Identifier: Apache-2.0
/// Logs that are text: CSV, blanks, columns by number, the project's own, the uquad's, replays.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "log_files/read_logs.hpp"
#include "log_files/sample_logs.hpp"
#include "numbers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "quadtune/logs/log_channels.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::AllOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::NanSensitiveDoubleEq;
using testing::read_bytes;
using testing::read_whole;
using ::testing::ThrowsMessage;
using testing::WholeGroup;
using testing::WholeLog;
using testing::with_columns;

using testing::kNaN;

TEST(TextLog, TakesNamesUnitsAndTimeFromTheHeader) {
  const WholeLog log =
      read_bytes("t[s],z [m],w_x [rad s^-1],a(m/s2),height_m,n\n0,1,2,3,4,5\n0.5,-1,2e3,.5,+4,\n");
  EXPECT_EQ(log.format, "text");
  const WholeGroup& table = log.group("");
  EXPECT_THAT(table.names(), ElementsAre("z", "w_x", "a", "height_m", "n"));
  EXPECT_THAT(table.units(), ElementsAre("m", "rad/s", "m/s^2", "m", ""));
  EXPECT_THAT(table.time, ElementsAre(0, 0.5));
  EXPECT_THAT(table.rows[0], ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(table.rows[1], ElementsAre(-1, 2000, 0.5, 4, NanSensitiveDoubleEq(kNaN)));
  EXPECT_TRUE(log.condition.whole());
  EXPECT_THAT(log.condition.notes, IsEmpty());
}

// Nanoseconds since 1970 differ by less than a double of seconds holds.
TEST(TextLog, KeepsNanosecondsSince1970) {
  const WholeLog log =
      read_bytes("#timestamp [ns],x\n1403715273262142976,1\n1403715273267142912,2\n");
  EXPECT_EQ(log.epoch_s, 1403715273);
  EXPECT_THAT(log.group("").time, ElementsAre(DoubleEq(0.262142976), DoubleEq(0.267142912)));
  const WholeLog decimal = read_bytes("t,x\n1403715273.262142976,1\n1403715273.267142912,2\n");
  EXPECT_THAT(decimal.group("").time, ElementsAre(DoubleEq(0.262142976), DoubleEq(0.267142912)));
  LogOptions earlier;  // so that two files share a clock
  earlier.epoch_s = 1403715270;
  EXPECT_THAT(read_bytes("#timestamp [ns],x\n1403715273262142976,1\n", earlier).group("").time,
              ElementsAre(DoubleEq(3.262142976)));
}

TEST(TextLog, TimesMayBeNegativeFractionsOrPowers) {
  EXPECT_THAT(read_bytes("t,x\n-0.5,1\n-1.25,2\n-.5,3\n+2,4\n5e-1,5\n2.,6\n").group("").time,
              ElementsAre(-0.5, -1.25, -0.5, 2, 0.5, 2));
}

// The seconds have the digits that the epoch is taken from, wherever they stand.
TEST(TextLog, PartsOfTheTimeKeepTheEpoch) {
  const WholeLog log = read_bytes("250000 1403715273 7\n", with_columns("t_us:1, t_s:2, x:3"));
  EXPECT_EQ(log.epoch_s, 1403715273);
  EXPECT_THAT(log.group("").time, ElementsAre(0.25));
}

TEST(TextLog, FindsTheSeparator) {
  for (const char* text :
       {"t;x;y\n1;2;3\n", "t\tx\ty\n1\t2\t3\n", "t x y\n1 2 3\n", "  t   x \t y\n 1\t 2  3 \n",
        "t, x, y\n1, 2 ,3\n", "t,x,y,\n1,2,3,\n", "\xef\xbb\xbft,x,y\r\n1,2,3\r\n",
        "# a comment\n% t x y\n1 2 3\n", "\"t\",\"x\",\"y\"\n1,2,3\n"}) {
    const WholeLog log = read_bytes(text);
    EXPECT_THAT(log.group("").names(), ElementsAre("x", "y")) << text;
    ASSERT_EQ(log.group("").rows.size(), 1U) << text;
    EXPECT_THAT(log.group("").rows[0], ElementsAre(2, 3)) << text;
    EXPECT_THAT(log.group("").time, ElementsAre(1)) << text;
  }
}

TEST(TextLog, AnIndexIsNoUnit) {
  EXPECT_THAT(read_bytes("t,q[0],q[1],n[1]\n0,1,2,3\n").group("").names(),
              ElementsAre("q[0]", "q[1]", "n"));
}

TEST(TextLog, WithoutNamesAndTimeSaysSo) {
  const WholeLog log = read_bytes("1 2\n3 4\n");
  EXPECT_THAT(log.group("").names(), ElementsAre("c1", "c2"));
  EXPECT_FALSE(log.group("").group.timed);
  EXPECT_THAT(log.condition.notes, ElementsAre(HasSubstr("--columns")));
}

TEST(TextLog, TakesColumnsByNumberAndAddsPartsOfTheTime) {
  const std::string text = "0001 999999 7 1.5 x\n0002 000001 7 -2 y\n";
  const WholeLog log = read_bytes(text, with_columns("t_us:2, t_s:1, height[m]:4"));
  EXPECT_THAT(log.group("").time, ElementsAre(DoubleEq(1.999999), DoubleEq(2.000001)));
  EXPECT_THAT(log.group("").column("height"), ElementsAre(1.5, -2));
  EXPECT_THAT(log.group("").units(), ElementsAre("m"));
  const WholeLog next = read_bytes("1 2 3\n", with_columns("a:2, b[rad]", 10));
  EXPECT_THAT(next.group("").rows[0], ElementsAre(2, 3));
  const WholeLog rest = read_bytes("stamp,b,c\n1500,2,3\n", with_columns("t_ms:stamp, *"));
  EXPECT_THAT(rest.group("").names(), ElementsAre("b", "c"));
  EXPECT_THAT(rest.group("").time, ElementsAre(1.5));
}

TEST(TextLog, NotesAUnitThatReplacesThatOfTheNames) {
  const auto notes = [](const std::string& text, const char* columns) {
    return read_bytes(text, with_columns(columns, 10)).condition.notes;
  };
  EXPECT_THAT(notes("h[m]\n1\n", "height[cm]:h"),
              ElementsAre("the line of names gives the unit m of 'h'; the unit cm of --columns "
                          "replaces it"));
  EXPECT_THAT(notes("h[m],k\n1,2\n", "height[m]:h, k[cm]"), IsEmpty());
  const WholeLog log = read_bytes("stamp[ms],h\n1000,1\n1010,2\n", with_columns("t_us:stamp, *"));
  EXPECT_THAT(log.condition.notes, ElementsAre(HasSubstr("unit ms of 'stamp'; the unit us of")));
}

TEST(TextLog, ARateCountsRowsAlsoThoseThatAreBroken) {
  const WholeLog log = read_bytes("a,b\n1,2\n1\n5,6\n", with_columns("a,b", 4));
  EXPECT_THAT(log.group("").time, ElementsAre(0, 0.5));
  EXPECT_EQ(log.condition.skipped, 1U);
  EXPECT_EQ(log.condition.first_skipped, "f.log:3: the row has 1 field, expected 2");
}

TEST(TextLog, RefusesColumnsThatAreNotThere) {
  const auto refused = [](const std::string& columns, const std::string& text, double rate = 0) {
    return [=] { (void)read_bytes(text, with_columns(columns, rate)); };
  };
  EXPECT_THAT(refused("hight[m]", "t,height\n1,2\n"),
              ThrowsMessage<InvalidInput>("f.log: has no column 'hight'; did you mean 'height'?"));
  EXPECT_THAT(refused("a:3", "1 2\n"),
              ThrowsMessage<InvalidInput>("f.log: has no column 3 for 'a', expected 1 to 2"));
  EXPECT_THAT(refused("a:x", "1 2\n"),
              ThrowsMessage<InvalidInput>(HasSubstr("no line of column names")));
  EXPECT_THAT(refused("a:1,b:1", "1 2\n"),
              ThrowsMessage<InvalidInput>(HasSubstr("selected twice")));
  EXPECT_THAT(refused("t_s:1,b:2", "1 2\n", 5), ThrowsMessage<InvalidInput>(HasSubstr("a rate")));
  for (const char* text : {"", ",", "a:", ":1", "a,,b"})
    EXPECT_THAT([=] { (void)parse_log_columns(text, "--columns"); },
                ThrowsMessage<InvalidInput>(HasSubstr("is not a column")))
        << text;
  EXPECT_THAT([] { (void)parse_log_columns("a:1,a:2", "--columns"); },
              ThrowsMessage<InvalidInput>(HasSubstr("'a' is given twice")));
}

TEST(TextLog, RowsWithoutTimeAndFieldsWithoutNumberAreCounted) {
  const WholeLog log = read_bytes("t,mode,x\n0,MANUAL,1\n,AUTO,2\n2,3,1e999\n");
  EXPECT_THAT(log.group("").time, ElementsAre(0, 2));
  EXPECT_TRUE(std::isnan(log.group("").rows[0][0]));
  EXPECT_EQ(log.group("").rows[1][0], 3);
  EXPECT_EQ(log.condition.first_skipped,
            "f.log:3: the time of the row is missing or no number with a decimal point");
  EXPECT_THAT(
      log.condition.notes,
      ElementsAre(
          HasSubstr("'mode': 1 of 2 rows has no number, or one that exceeds the range of a double"),
          HasSubstr("'x': 1 of 2 rows has no number")));
}

// Rows of a clock that begins at `first` and goes in `step`, below `names`.
std::string clocked(const std::string& names, std::int64_t first, std::int64_t step) {
  std::string text = names + "\n";
  for (std::int64_t k = 0; k < 30; ++k) text += std::to_string(first + step * k) + ",1\n";
  return text;
}

TEST(TextLog, TakesTimesSince1970InTheUnitThatTheirValuesShow) {
  struct Case {
    const char* names;
    std::int64_t first, step;
    const char* said;
  };
  for (const Case& one : {Case{"#timestamp,x", 1403636579758555392, 5000000, "nanoseconds"},
                          Case{"%time,field.x", 1403636579758555392, 5000000, "nanoseconds"},
                          Case{"field.header.stamp,x", 1403636579758555392, 5000000, "nanoseconds"},
                          Case{"t,x", 1403636579758555, 5000, "microseconds"},
                          Case{"Time,x", 1403636579758, 5, "milliseconds"}}) {
    const WholeLog log = read_bytes(clocked(one.names, one.first, one.step));
    EXPECT_EQ(log.epoch_s, 1403636579) << one.names;
    ASSERT_EQ(log.group("").time.size(), 30U) << one.names;
    EXPECT_NEAR(log.group("").time[1] - log.group("").time[0], 0.005, 1e-12) << one.names;
    EXPECT_THAT(log.condition.notes,
                ElementsAre(AllOf(HasSubstr("states no unit and is taken as " +
                                            std::string(one.said) + " since 1970"),
                                  HasSubstr("with samples 0.005 s apart"))))
        << one.names;
    // No note if the user states the unit.
    EXPECT_THAT(read_bytes(clocked(one.names, one.first, one.step), with_columns("t_ns:1, x:2"))
                    .condition.notes,
                IsEmpty());
  }
}

TEST(TextLog, SaysThatTheUnitOfAClockIsAmbiguous) {
  struct Case {
    std::int64_t first, step;
    const char* why;
  };
  for (const Case& one :
       {Case{0, 4000, "in seconds its samples would be 4000 s apart"},         // us from the start
        Case{38116000, 4000, "in seconds its samples would be 4000 s apart"},  // ULog as CSV
        Case{250000000000, 5000000, "its values, such as 2.50075e+11, are not seconds"},  // ns
        Case{1403636579758, 4000, "are not seconds"},        // ms or us
        Case{200000000000000, 50000000, "are not seconds"},  // ns of a clock that runs for two days
        Case{20000000000000000, 5000000, "are not seconds"}})  // ns of one that runs for 230 days
    EXPECT_THAT(read_bytes(clocked("timestamp,x", one.first, one.step)).condition.unclear_time,
                AllOf(HasSubstr("the clock 'timestamp' states no unit, and "), HasSubstr(one.why),
                      HasSubstr("s:timestamp, *'")))
        << one.first;
  EXPECT_THAT(read_bytes("0 1\n4000 2\n8000 3\n", with_columns("t:1, x:2")).condition.unclear_time,
              HasSubstr("the clock column 1 states no unit"));
  // `log` prints a note; commands that use the times reject the log.
  const testing::TemporaryDirectory folder;
  const std::string file = folder.write("us.csv", clocked("timestamp,x", 0, 4000));
  EXPECT_THAT(read_whole(*open_log(file)).condition.notes,
              ElementsAre(HasSubstr("in seconds its samples would be 4000 s apart")));
  EXPECT_THAT(
      [&] { (void)read_log_channels(file, {"x"}); },
      ThrowsMessage<InvalidInput>(HasSubstr(file + ": the clock 'timestamp' states no unit")));
  EXPECT_EQ(read_log_channels(file, {"x"}, with_columns("t_us:timestamp, *")).series[0].time[1],
            0.004);
  EXPECT_THAT(read_bytes(clocked("timestamp,x", 0, 4000), with_columns("t_us:timestamp, *"))
                  .group("")
                  .time[1],
              DoubleEq(0.004));
}

TEST(TextLog, RefusesATimeInAnotherUnit) {
  EXPECT_THAT([] { (void)read_bytes("a,t[min]\n1,0\n2,1\n", with_columns("t:2, *")); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "f.log: the time column 't' is in 'min', expected s, ms, us or ns; state")));
  EXPECT_FALSE(read_bytes("a,t[min]\n1,0\n2,1\n").group("").group.timed);
  EXPECT_THAT(read_bytes("a,t[min]\n1,0\n2,1\n", with_columns("t_s:2, *")).group("").time,
              ElementsAre(0, 1));
  EXPECT_THAT(read_bytes("a,Time [Seconds]\n1,0\n2,0.5\n").group("").time, ElementsAre(0, 0.5));
}

TEST(TextLog, TakesSecondsWithAWord) {
  const WholeLog log = read_bytes("timestamp,x\n1403636579.75,1\n1403636579.80,2\n");
  EXPECT_THAT(log.condition.notes,
              ElementsAre(AllOf(HasSubstr("is taken as seconds, with samples 0.05 s apart"),
                                HasSubstr("--columns 't_us:timestamp, *'"))));
  EXPECT_THAT(read_bytes("t,x\n0,1\n0.1,2\n").condition.notes, IsEmpty());
  // A ground truth as OpenVINS writes it.
  const WholeLog truth = read_bytes(
      "# timestamp(s) tx ty\n1.403636580838555574e+09 1.0 2.0\n1.403636580843555328e+09 1.1 2\n");
  EXPECT_THAT(truth.group("").names(), ElementsAre("tx", "ty"));
  EXPECT_EQ(truth.epoch_s, 1403636580);
  EXPECT_NEAR(truth.group("").time[1] - truth.group("").time[0], 0.005, 1e-6);
  EXPECT_THAT(truth.condition.notes, IsEmpty());
}

// A clock called t counts seconds as a rule; milliseconds of a log at 200 Hz look like samples 5 s
// apart.
TEST(TextLog, SaysThatASlowClockMayCountMilliseconds) {
  EXPECT_THAT(
      read_bytes("t,x\n0,1\n5,2\n10,2\n").condition.notes,
      ElementsAre(AllOf(
          HasSubstr("the clock 't' states no unit and is taken as seconds, with samples 5 s apart"),
          HasSubstr("--columns 't_us:t, *'"))));
  EXPECT_THAT(read_bytes("t_s,x\n0,1\n5,2\n10,2\n").condition.notes, IsEmpty());
}

TEST(TextLog, RefusesAStatedUnitByWhichTheTimeIsNone) {
  const std::string bytes = "t_s,x\n1403636579758555392,1\n1403636579763555584,2\n";
  const LogCondition condition = read_bytes(bytes).condition;
  EXPECT_THAT(condition.unclear_time, HasSubstr("the clock is stated in s, but its values, such as "
                                                "1.40364e+18, would be after the year 2286"));
  EXPECT_THAT(
      read_bytes("t_ns,x\n1403636579758555392,1\n1403636579763555584,2\n").condition.unclear_time,
      IsEmpty());
}

TEST(TextLog, KnowsClocksByTheirNames) {
  for (const char* name : {"TimeUS", "time_usec", "timestamp_us", "t [us]", "Timestamp(usec)"}) {
    const WholeLog log = read_bytes(clocked(std::string(name) + ",x", 5000000, 4000));
    EXPECT_THAT(log.group("").time[1], DoubleEq(5.004)) << name;
    EXPECT_THAT(log.condition.notes, IsEmpty()) << name;
  }
  EXPECT_FALSE(read_bytes("times,x\n1,2\n").group("").group.timed);
}

TEST(TextLog, LeavesOutRowsWhoseTimeWasNeverSet) {
  std::string text = "t_ns,x\n0,-1\n0,-1\n";
  for (std::int64_t k = 0; k < 50; ++k) {
    text += std::to_string(1700000000000000000 + 20000000 * k) + ",1\n";
    if (k == 20) text += "0,-1\n";
  }
  const WholeLog log = read_bytes(text);
  EXPECT_EQ(log.epoch_s, 1700000000);
  EXPECT_EQ(log.group("").time.size(), 50U);
  EXPECT_THAT(log.group("").time.back(), DoubleEq(0.98));
  EXPECT_THAT(log.group("").column("x"), ::testing::Each(1));
  EXPECT_THAT(log.condition.notes,
              ElementsAre(AllOf(HasSubstr("3 of 53 rows are at time 0 (clock not set)"),
                                HasSubstr("the first at f.log:2"))));
  EXPECT_TRUE(log.condition.whole());
  // A clock that begins at 0 does so in earnest.
  EXPECT_EQ(read_bytes(clocked("t_us,x", 0, 4000)).group("").time.size(), 30U);
  EXPECT_EQ(read_bytes(clocked("t_s,x", 0, 5)).group("").time.size(), 30U);
}

TEST(TextLog, RefusesATextThatIsMostlyNoTable) {
  std::string text = "t,x\n";
  for (int i = 0; i < 10; ++i) text += "1,2\n1,2,3\n";
  EXPECT_EQ(read_bytes(text).condition.skipped, 10U);
  EXPECT_THAT([&] { (void)read_bytes(text + "7\n"); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("f.log: 11 of 21 rows cannot be read; with more than half"),
                        HasSubstr("f.log:3: the row has 3 fields, expected 2"))));
}

TEST(TextLog, NamesFormatsThatItDoesNotRead) {
  const std::string ardupilot =
      "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
      "FMT, 129, 31, PARM, QNf, TimeUS,Name,Value\nPARM, 3464, SYSID, 120\n";
  for (const std::string& text : {ardupilot, "ArduCopter V3.2\nFree RAM: 1\n" + ardupilot})
    EXPECT_THAT([&] { (void)read_bytes(text); },
                ThrowsMessage<InvalidInput>(
                    AllOf(HasSubstr("f.log: is an ArduPilot text log with several kinds of rows"),
                          HasSubstr("mavlogdump"))));
  const std::vector<std::pair<std::string, std::string>> others = {
      {"\xa3\x95\x80", "ArduPilot log (DataFlash)"},
      {"H Product:Blackbox flight data recorder\n", "Betaflight"},
      {"#ROSBAG V2.0\n", "ROS bag"},
      {"\x1f\x8b\x08", "decompress it first"},
      {"# a vehicle\nname = \"quad\"\n\n[body]\nmass_kg = 1\n", "settings file"},
      {"[[rotors]]\nx = 1\n", "settings file"},
      {"{\n  \"time\": [0, 1]\n}\n", "is JSON"},
      {"<!doctype html>\n", "is a page"}};
  for (const auto& other : others)
    EXPECT_THAT([&] { (void)read_bytes(other.first); },
                ThrowsMessage<InvalidInput>(HasSubstr(other.second)));
}

// A header that looks like a setting is one: settings have no rows of numbers below.
TEST(TextLog, ReadsTablesWhoseHeaderLooksLikeASetting) {
  for (const std::string header : {"a=b,t\n", "[x],t\n"})
    EXPECT_NO_THROW((void)read_bytes(header + "1,0\n2,0.1\n3,0.2\n")) << header;
}

TEST(TextLog, RefusesWhatIsNoLog) {
  EXPECT_THAT([] { (void)read_bytes(""); }, ThrowsMessage<InvalidInput>(HasSubstr("is empty")));
  EXPECT_THAT([] { (void)read_bytes("1 2"); },
              ThrowsMessage<InvalidInput>(HasSubstr("no complete line")));
  EXPECT_THAT([] { (void)read_bytes(std::string("a\0b\n", 4)); },
              ThrowsMessage<InvalidInput>(HasSubstr("zero byte")));
  EXPECT_THAT([] { (void)read_bytes("t,x\n1\n2\n"); },
              ThrowsMessage<InvalidInput>(HasSubstr("no other row")));
  EXPECT_THAT([] { (void)read_bytes("{\n  one: two,\n  three: four,\n}\n"); },
              ThrowsMessage<InvalidInput>("f.log: holds no number and no time, expected a log"));
  EXPECT_THAT([] { (void)open_log("/nowhere/f.csv"); },
              ThrowsMessage<FileError>(HasSubstr("No such file")));
  LogOptions options;
  options.format = "ulgo";
  EXPECT_THAT([&] { (void)read_bytes("1\n", options); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected one of text, replay, ulog")));
  options.format = "replay";
  options.rate_hz = 3;
  EXPECT_THAT([&] { (void)read_bytes("1\n", options); },
              ThrowsMessage<InvalidInput>(HasSubstr("apply to text only")));
}

TEST(TextLog, AHeadAloneIsALogWithoutRows) {
  const WholeLog log = read_bytes("t,x[m]\n");
  EXPECT_THAT(log.group("").names(), ElementsAre("x"));
  EXPECT_TRUE(log.condition.whole());
  EXPECT_THAT(log.condition.notes,
              ElementsAre("f.log: has a header but no row, so that it holds no measurement"));
  EXPECT_THAT(read_bytes("t,x[m]\n1,2\n").condition.notes, ElementsAre());
}

TEST(TextLog, SaysThatARateReplacesTheTimesOfTheFile) {
  LogOptions options;
  options.rate_hz = 4;
  const WholeLog log = read_bytes("t,x\n1,2\n3,4\n", options);
  EXPECT_THAT(log.group("").names(), ElementsAre("t", "x"));
  EXPECT_THAT(log.condition.notes,
              ElementsAre("the rate of 4 Hz determines the times, and the times in the column "
                          "'t' are not used"));
  EXPECT_THAT(read_bytes("a,x\n1,2\n3,4\n", options).condition.notes, ElementsAre());
}

TEST(TextLog, AcceptsALineThatIsTooLongAsTheEnd) {
  const WholeLog log = read_bytes("t,x\n1,2\n" + std::string(3, '9'));
  EXPECT_EQ(log.group("").rows.size(), 1U);
  EXPECT_THAT(log.condition.torn, HasSubstr("f.log:3: the line does not end"));
}

TEST(TextLog, ReadsTheProjectsOwnFlightLogs) {
  const std::string csv = csv_of(testing::small_log());
  const WholeLog log = read_bytes(csv);
  EXPECT_THAT(log.group("").names(), ElementsAre("x.px", "gps.px"));
  EXPECT_THAT(log.group("").units(), ElementsAre("m", "m"));
  EXPECT_THAT(log.group("").time, ElementsAre(0, 0.005));
  EXPECT_TRUE(log.condition.whole());
  const WholeLog short_one = read_bytes(csv.substr(0, csv.rfind("0.005")));
  EXPECT_THAT(short_one.condition.torn, HasSubstr("has 1 row, expected 2 as its header states"));
}

TEST(UquadLog, FramesAddUpTheirTimes) {
  const std::string frame = "\t1\t2\t3\t4\t5\t6\t7\t8\t9\t288\t100947\tZ\n";
  const WholeLog log =
      read_bytes("A\t23408" + frame + "A\t23404" + frame + "A\tx" + frame + "A\t10" + frame);
  EXPECT_EQ(log.format, "uquad-frames");
  EXPECT_THAT(log.group("").time, ElementsAre(0, DoubleEq(0.023404), DoubleEq(0.023414)));
  EXPECT_THAT(log.group("").rows[0],
              ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, DoubleEq(28.8), 100947));
  EXPECT_EQ(log.condition.skipped, 1U);
}

TEST(UquadLog, OfTheMainProgramHasTwoTimesBefore) {
  LogOptions options;
  options.format = "uquad-log";
  const std::string readings = "1 2 3 4 5 6 7 8 9 288 100947\n";
  const WholeLog plain = read_bytes("5 250000 " + readings, options);
  EXPECT_THAT(plain.group("").time, ElementsAre(5.25));
  EXPECT_THAT(plain.group("").column("pressure"), ElementsAre(100947));
  const WholeLog with_period = read_bytes("5 250000 10000 " + readings, options);
  EXPECT_THAT(with_period.group("").column("acc_x"), ElementsAre(1));
  EXPECT_THAT(with_period.group("").column("T_us"), ElementsAre(10000));
  EXPECT_THAT([&] { (void)read_bytes("1 2 3\n", options); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("has 3 columns separated by blanks, expected 13 or 14")));
}

TEST(ReplayLog, MakesAGroupOfEachSensorInTheOrderOfTheFile) {
  const WholeLog log = read_bytes(
      "4000,baro,487.5\r\n4000,imu,1,2,3,4,5,6\r\n8000,imu,1,2,3,4,5,7\r\n8000,baro,488\r\n"
      "9000,odd,1,2\r\n9000,odd,1\r\nx,imu,1\r\n");
  EXPECT_EQ(log.format, "replay");
  EXPECT_THAT(log.order, ElementsAre(0, 1, 0, 2));
  EXPECT_THAT(log.group("baro").time, ElementsAre(0.004, 0.008));
  EXPECT_THAT(log.group("baro").units(), ElementsAre("m"));
  EXPECT_THAT(log.group("imu").column("gyro_z"), ElementsAre(6, 7));
  EXPECT_THAT(log.group("odd").names(), ElementsAre("v[1]", "v[2]"));
  EXPECT_EQ(log.condition.skipped, 2U);
  EXPECT_EQ(log.condition.first_skipped,
            "f.log:6: odd has 1 value, expected 2 as in previous lines");
}

// They used to be ignored without a message.
TEST(TextLog, TellsOfNamesThatAreTooManyOrTooFew) {
  const WholeLog few = read_bytes("# t,x\n0,1,2\n1,2,3\n");
  EXPECT_THAT(few.group("").names(), ElementsAre("c1", "c2", "c3"));
  EXPECT_THAT(few.condition.notes,
              ::testing::Contains(HasSubstr("'t,x', has 2 fields, expected 3")));
  EXPECT_THAT(read_bytes("# t,x,y,z\n0,1,2\n").condition.notes,
              ::testing::Contains(HasSubstr("has 4 fields, expected 3")));
  for (const char* text : {"# a log\n# t,x,y\n0,1,2\n", "# recorded\n0,1,2\n", "0,1,2\n"})
    EXPECT_THAT(read_bytes(text).condition.notes,
                ::testing::Not(::testing::Contains(HasSubstr("have no names"))))
        << text;
}

}  // namespace
}  // namespace quadtune
