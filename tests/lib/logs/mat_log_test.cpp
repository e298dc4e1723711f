// SPDX-License-Identifier: Apache-2.0
/// MAT files of other programs, through the guarded process.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "log_files/mat_writer.hpp"
#include "log_files/read_logs.hpp"
#include "log_files/sample_logs.hpp"
#include "logs/mat/guarded_process.hpp"
#include "logs/mat/memory_file.hpp"
#include "logs/mat/system_call_filter.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "temporary_directory.hpp"

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

TEST(MatLog, JudgesAClockWithoutUnitByItsValues) {
  const auto log_of = [](double first, double step) {
    MatWriter mat(false);
    mat.matrix("time", {3, 1}, {first, first + step, first + 2 * step});
    mat.matrix("z", {3, 1}, {1, 2, 3});
    return read_bytes(mat.bytes());
  };
  const WholeLog us = log_of(1700000000e6, 5000);
  EXPECT_EQ(us.epoch_s, 1700000000);
  EXPECT_THAT(us.group("").time[1], ::testing::DoubleNear(0.005, 1e-6));
  EXPECT_THAT(us.condition.notes,
              ElementsAre(HasSubstr("the clock 'time' states no unit and is taken as microseconds "
                                    "since 1970")));
  EXPECT_THAT(log_of(3, 0.5).condition.notes, ::testing::IsEmpty());
  const WholeLog ambiguous = log_of(0, 4000);
  EXPECT_FALSE(ambiguous.group("").group.timed);
  EXPECT_THAT(ambiguous.group("").names(), ElementsAre("time", "z"));
  EXPECT_THAT(ambiguous.condition.notes,
              ElementsAre("'time' states no unit and is no clock, because as seconds its samples "
                          "would be 4000 s apart; they may be milliseconds, microseconds or "
                          "nanoseconds: call it time_us"));
}

TEST(MatLog, LeavesOutRowsWhoseTimeWasNeverSet) {
  MatWriter mat(false);
  mat.matrix("t_s", {4, 1}, {0, 1700000000.0, 1700000000.5, 1700000001.0});
  mat.matrix("z", {4, 1}, {7, 1, 2, 3});
  const WholeLog log = read_bytes(mat.bytes());
  EXPECT_EQ(log.epoch_s, 1700000000);
  EXPECT_THAT(log.group("").time, ElementsAre(0, 0.5, 1));
  EXPECT_THAT(log.group("").column("z"), ElementsAre(1, 2, 3));
  EXPECT_THAT(log.condition.notes, ElementsAre(HasSubstr("1 of 4 rows of '' are at time 0")));
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

// The errors that system calls end with in a process under the filter.
struct Tried {
  int opened = 0, opened_for_writing = 0, listed = 0, reopened_pipe = 0, socket = 0, started = 0,
      killed = 0;
  bool in_memory = false, allocates = false;
};

Tried what_a_filtered_process_can() {
  Tried tried;
  const auto error_of = [](long result) { return result < 0 ? errno : 0; };
  tried.opened = error_of(::open("/etc/passwd", O_RDONLY | O_CLOEXEC));
  tried.opened_for_writing = error_of(
      ::openat(AT_FDCWD, "/tmp/quadtune-must-not-be", O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  tried.listed = error_of(::open("/proc/self/fd", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  tried.reopened_pipe = error_of(::open("/proc/self/fd/0x", O_RDONLY | O_CLOEXEC));
  tried.socket = error_of(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  tried.started = error_of(::fork());
  tried.killed = error_of(::kill(::getppid(), 0));
  const internal::MemoryFile file;
  file.write("in memory");
  const int again = ::open(file.path().c_str(), O_RDONLY | O_CLOEXEC);
  std::array<char, 16> bytes{};
  tried.in_memory = ::read(again, bytes.data(), bytes.size()) == 9 &&
                    std::string_view(bytes.data()) == "in memory" && ::close(again) == 0;
  tried.allocates = std::vector<double>(10'000'000, 1).back() == 1;
  return tried;
}

TEST(SystemCallFilter, OpensNoFileAndMakesNoSocket) {
  GuardedProcess child({std::size_t{4} << 30U, 10}, [](int pipe) {
    const bool confined = internal::forbid_system_calls();
    const Tried tried = confined ? what_a_filtered_process_can() : Tried{};
    (void)internal::write_fully(pipe, &confined, sizeof confined);
    (void)internal::write_fully(pipe, &tried, sizeof tried);
  });
  bool confined = false;
  Tried tried;
  ASSERT_TRUE(child.read(&confined, sizeof confined)) << child.why_ended();
  if (!confined) GTEST_SKIP() << "this system lets no filter of system calls be set";
  ASSERT_TRUE(child.read(&tried, sizeof tried)) << child.why_ended();
  EXPECT_EQ(tried.opened, EPERM);
  EXPECT_EQ(tried.opened_for_writing, EPERM);
  EXPECT_EQ(tried.listed, EPERM);
  EXPECT_EQ(tried.reopened_pipe, EPERM);
  EXPECT_EQ(tried.socket, EPERM);
  EXPECT_EQ(tried.started, EPERM);
  EXPECT_EQ(tried.killed, EPERM);
  EXPECT_TRUE(tried.in_memory);
  EXPECT_TRUE(tried.allocates);
  EXPECT_EQ(::access("/tmp/quadtune-must-not-be", F_OK), -1);
}

// Whether a child of this process is under a filter, as the kernel says.
bool has_filtered_child() {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (int child = 0; children >> child;) {
      std::ifstream status(fmt::format("/proc/{}/status", child));
      for (std::string line; std::getline(status, line);)
        if (line.starts_with("Seccomp:") && line.ends_with("2")) return true;
    }
  }
  return false;
}

// The process that reads a MAT file waits for the rest of it, and is looked at meanwhile.
TEST(SystemCallFilter, IsSetWhereMatFilesAreRead) {
  bool available = false;
  GuardedProcess probe({std::size_t{4} << 30U, 10}, [](int pipe) {
    const bool confined = internal::forbid_system_calls();
    (void)internal::write_fully(pipe, &confined, sizeof confined);
  });
  ASSERT_TRUE(probe.read(&available, sizeof available));
  if (!available ||
      !std::filesystem::exists("/proc/self/task/" + std::to_string(::getpid()) + "/children"))
    GTEST_SKIP() << "no filter of system calls here, or no list of children";
  EXPECT_EQ(probe.why_ended(), "ended with status 0");
  MatWriter mat(false);
  mat.matrix("t_s", {2000, 1}, std::vector<double>(2000, 1)).matrix("z", {2, 1}, {1, 2});
  const std::string bytes = mat.bytes();
  const testing::TemporaryDirectory folder;
  const std::string fifo = (folder.path() / "f.mat").string();
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  // A process of its own writes: the reading one has what this one has open, and would wait for it.
  const std::filesystem::path looked = folder.path() / "looked";
  GuardedProcess writer({std::size_t{4} << 30U, 60}, [&](int) {
    std::ofstream pipe(fifo, std::ios::binary);
    const auto most = static_cast<std::streamsize>(bytes.size() - 1);
    pipe.write(bytes.data(), most).flush();
    while (!std::filesystem::exists(looked)) ::usleep(10000);
    pipe.write(bytes.data() + most, 1);
  });
  WholeLog log;
  std::thread reader([&] { log = testing::read_whole(*open_log(fifo)); });
  bool filtered = false;
  for (int i = 0; i < 6000 && !filtered; ++i) {
    filtered = has_filtered_child();
    if (!filtered) ::usleep(10000);
  }
  EXPECT_TRUE(filtered);
  folder.write("looked", "");
  reader.join();
  EXPECT_EQ(log.group("").column("z").size(), 2U);
  EXPECT_TRUE(log.condition.whole()) << log.condition.torn;
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
