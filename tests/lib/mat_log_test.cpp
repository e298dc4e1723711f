// SPDX-License-Identifier: Apache-2.0
/// MAT files of other programs, through the guarded process.
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <vector>

#include "logs/guarded_process.hpp"
#include "mat_writer.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "read_logs.hpp"
#include "sample_logs.hpp"

namespace quadtune {
namespace {

using internal::GuardedProcess;
using ::testing::AnyOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatWriter;
using testing::read_bytes;
using ::testing::ThrowsMessage;
using testing::WholeLog;

TEST(MatLog, VectorsOfOneLengthShareTheClock) {
  for (const bool compressed : {false, true}) {
    MatWriter mat(compressed);
    mat.matrix("z", {3, 1}, {1, 2, 3}).matrix("t_ms", {1, 3}, {0, 5, 10});
    mat.matrix("M", {3, 2}, {1, 2, 3, 4, 5, 6}).matrix("other", {2, 1}, {8, 9});
    mat.matrix("g", {1, 1}, {9.81});
    const WholeLog log = read_bytes(mat.bytes());
    EXPECT_EQ(log.format, "mat");
    ASSERT_EQ(log.groups.size(), 2U);
    EXPECT_THAT(log.group("rows3").names(), ElementsAre("z", "M[1]", "M[2]"));
    EXPECT_THAT(log.group("rows3").time, ElementsAre(0, DoubleEq(0.005), DoubleEq(0.01)));
    EXPECT_THAT(log.group("rows3").rows[2], ElementsAre(3, 3, 6));
    EXPECT_FALSE(log.group("rows2").group.timed);
    EXPECT_THAT(log.condition.notes, ElementsAre("single numbers are passed over: g"));
  }
}

TEST(MatLog, ReadsWhatSimulinkWrites) {
  for (const bool inner_names : {false, true}) {  // generated code names what fields hold once more
    MatWriter mat(false, inner_names);
    mat.simulink("rt_yout", {0, 0.5}, {{"motors", {2, 2}, {1, 2, 3, 4}}, {"flag", {2, 1}, {0, 1}}});
    mat.simulink("cube", {0, 0.5}, {{"", {1, 2, 2}, {1, 2, 3, 4}}});
    const WholeLog log = read_bytes(mat.bytes());
    EXPECT_THAT(log.group("rt_yout").names(), ElementsAre("motors[1]", "motors[2]", "flag"));
    EXPECT_THAT(log.group("rt_yout").time, ElementsAre(0, 0.5));
    EXPECT_THAT(log.group("rt_yout").rows[1], ElementsAre(2, 4, 1));
    EXPECT_THAT(log.group("cube").rows[1], ElementsAre(3, 4));  // the last dimension is the time
    EXPECT_TRUE(log.condition.whole()) << log.condition.first_skipped;
  }
}

TEST(MatLog, ReadsTheProjectsOwnLogsLikeTheirCsv) {
  const LogTable table = testing::small_log();
  const WholeLog mat = read_bytes(bytes_of_mat(table));
  const WholeLog csv = read_bytes(csv_of(table));
  ASSERT_EQ(mat.groups.size(), 1U);
  EXPECT_EQ(mat.groups[0].group.name, csv.groups[0].group.name);
  EXPECT_EQ(mat.groups[0].names(), csv.groups[0].names());
  EXPECT_EQ(mat.groups[0].units(), csv.groups[0].units());
  EXPECT_EQ(mat.groups[0].time, csv.groups[0].time);
}

TEST(MatLog, TellsWhatWasTorn) {
  MatWriter mat(false);
  mat.matrix("a", {2, 1}, {1, 2});
  const std::size_t first = mat.bytes().size();
  mat.matrix("b", {2, 1}, {3, 4});
  const WholeLog log = read_bytes(mat.bytes().substr(0, mat.bytes().size() - 1));
  EXPECT_THAT(log.group("").names(), ElementsAre("a"));
  EXPECT_EQ(log.condition.torn,
            "f.log: the file ends within a variable at offset " + std::to_string(first));
}

TEST(MatLog, AWideMatrixIsNoLog) {
  MatWriter mat(true);
  mat.matrix("wide", {2, 10001}, std::vector<double>(20002)).matrix("z", {2, 1}, {3, 4});
  const WholeLog log = read_bytes(mat.bytes());
  EXPECT_THAT(log.group("").names(), ElementsAre("z"));
  EXPECT_THAT(log.condition.notes, ElementsAre(HasSubstr("'wide' has 10001 columns")));
}

// The checksum of a compressed variable is compared, so that no damaged number comes through.
TEST(MatLog, DamagedVariablesArePassedOver) {
  MatWriter mat(true);
  mat.matrix("a", {2, 1}, {1, 2}).matrix("b", {2, 1}, {3, 4});
  std::string bytes = mat.bytes();
  bytes[bytes.size() - 2] = static_cast<char>(bytes[bytes.size() - 2] ^ 1);
  const WholeLog log = read_bytes(bytes);
  EXPECT_THAT(log.group("").names(), ElementsAre("a"));
  EXPECT_EQ(log.condition.skipped, 1U);
  EXPECT_THAT(log.condition.first_skipped, HasSubstr("is damaged or too large"));
}

TEST(MatLog, RefusesOtherKindsWithTheWayOut) {
  std::string hdf5 = "MATLAB 7.3 MAT-file";
  hdf5.resize(512, ' ');
  hdf5 += "\x89HDF\r\n\x1a\n";
  EXPECT_THAT([&] { (void)read_bytes(hdf5); },
              ThrowsMessage<InvalidInput>("f.log: is a MAT v7.3 file, which is HDF5, expected MAT "
                                          "v5: save it with -v6"));
  EXPECT_THAT([] { (void)read_bytes("MATLAB 5.0"); },
              ThrowsMessage<InvalidInput>(HasSubstr("f.log: has 10 bytes")));
}

TEST(MatLog, NeedsNoMoreMemoryThanItMay) {
  MatWriter mat(true);
  mat.matrix("zeros", {1000000, 10}, std::vector<double>(10000000));
  LogOptions options;
  options.memory_limit = std::size_t{64} << 20U;
  EXPECT_THAT([&] { (void)read_bytes(mat.bytes(), options); },
              ThrowsMessage<InvalidInput>(
                  AnyOf(HasSubstr("needs more than 64 MiB of memory"), HasSubstr("too large"))));
}

// What no reader of ours does, matio may.
TEST(GuardedProcess, TellsHowItEnded) {
  char byte = 0;
  GuardedProcess fine({std::size_t{4} << 30U, 10},
                      [](int pipe) { (void)internal::write_fully(pipe, "x", 1); });
  EXPECT_TRUE(fine.read(&byte, 1));
  EXPECT_EQ(byte, 'x');
  EXPECT_FALSE(fine.read(&byte, 1));
  EXPECT_EQ(fine.why_ended(), "ended with status 0");

  GuardedProcess crash({std::size_t{4} << 30U, 10}, [](int) {
    ::signal(SIGSEGV, SIG_DFL);
    ::raise(SIGSEGV);
  });
  EXPECT_FALSE(crash.read(&byte, 1));
  EXPECT_EQ(crash.why_ended(), "was ended by signal 11");

  GuardedProcess talks_on({std::size_t{4} << 30U, 10}, [](int pipe) {
    while (internal::write_fully(pipe, "x", 1)) {
    }
  });
  EXPECT_TRUE(talks_on.read(&byte, 1));
  EXPECT_EQ(talks_on.why_ended(), "ended with status 0");

  // It never falls silent, so that it is the processor's time and not the clock that ends it,
  // however little of the processor a loaded machine gives it.
  GuardedProcess busy({std::size_t{4} << 30U, 1}, [](int pipe) {
    while (internal::write_fully(pipe, "x", 1)) {
    }
  });
  while (busy.read(&byte, 1)) {
  }
  EXPECT_EQ(busy.why_ended(), "ran into its limits of 1 s and 4096 MiB");

  GuardedProcess idle({std::size_t{4} << 30U, 0.1}, [](int) { ::pause(); });
  EXPECT_FALSE(idle.read(&byte, 1));
  EXPECT_EQ(idle.why_ended(), "took longer than 0.5 s");
}

}  // namespace
}  // namespace quadtune
