// SPDX-License-Identifier: Apache-2.0
// Exported flight code with other compilers, for other processors, with sanitizers, and checked
// against MISRA C.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "plants/flight_code_designs.hpp"
#include "plants/schedules.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using testing::flight_code_content;
using testing::FlightCodeCase;
using ::testing::HasSubstr;
using testing::random_schedule;
using testing::schedule_cases;
using testing::schedule_content_of;
using testing::ScheduleCase;
using testing::TemporaryDirectory;

/// The exit status of a shell command in a folder; its output is written to the file `log` there.
int run_in(const std::filesystem::path& folder, const std::string& command) {
  return std::system(fmt::format("cd '{}' && ( {} ) > log 2>&1", folder.string(), command).c_str());
}

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
}

/// Which functions call which, and the stack of each, as GCC writes them by -fcallgraph-info=su.
class CallGraph {
 public:
  void read(const std::filesystem::path& path) {
    static const std::regex node(
        R"re(node: \{ title: "([^"]+)" label: "[^"]*\\n(\d+) bytes \((\w+)\)")re");
    static const std::regex edge(R"re(edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)")re");
    std::ifstream lines(path);
    std::smatch found;
    for (std::string line; std::getline(lines, line);) {
      if (std::regex_search(line, found, edge)) calls_[found[1].str()].insert(found[2].str());
      if (!std::regex_search(line, found, node)) continue;
      EXPECT_EQ(found[3].str(), "static") << found[1].str() << " has a frame without a bound";
      frames_[found[1].str()] = std::stoi(found[2].str());
    }
  }
  /// The maximum stack depth of the calls that a function makes. Library functions are unknown and
  /// count as 0.
  /// @throws std::logic_error  if there is recursion
  [[nodiscard]] int deepest(const std::string& function,
                            const std::set<std::string>& callers = {}) const {
    if (callers.contains(function)) throw std::logic_error(function + " calls itself");
    std::set<std::string> nest = callers;
    nest.insert(function);
    int below = 0;
    if (const auto called = calls_.find(function); called != calls_.end())
      for (const std::string& next : called->second) below = std::max(below, deepest(next, nest));
    const auto frame = frames_.find(function);
    return below + (frame == frames_.end() ? 0 : frame->second);
  }

 private:
  std::map<std::string, int> frames_;  ///< [byte]
  std::map<std::string, std::set<std::string>> calls_;
};

class FlightCodeCompiled : public ::testing::TestWithParam<FlightCodeCase> {
 protected:
  void SetUp() override {
    write_files(folder_.path(), flight_code_files(flight_code_content(GetParam())));
  }

  const TemporaryDirectory folder_;
};

TEST_P(FlightCodeCompiled, ByClangRepeatsTheFlight) {
  if (!installed("clang")) GTEST_SKIP() << "clang is not installed here";
  EXPECT_EQ(run_in(folder_.path(),
                   "make CC=clang CFLAGS='-O2 -Wconversion -Wdouble-promotion -Werror' test"),
            0)
      << folder_.read("log");
}

TEST_P(FlightCodeCompiled, WithUndefinedBehaviourSanitizerRepeatsTheFlight) {
  EXPECT_EQ(run_in(folder_.path(),
                   "make CC=cc CFLAGS='-O1 -fsanitize=undefined,address "
                   "-fno-sanitize-recover=all' LDFLAGS=-fsanitize=undefined,address test"),
            0)
      << folder_.read("log");
}

TEST_P(FlightCodeCompiled, ForArmRepeatsTheFlight) {
  if (!installed("arm-linux-gnueabihf-gcc") || !installed("qemu-arm"))
    GTEST_SKIP() << "arm-linux-gnueabihf-gcc or qemu-arm is not installed here";
  EXPECT_EQ(
      run_in(folder_.path(),
             "make CC=arm-linux-gnueabihf-gcc CFLAGS='-O2 -mcpu=cortex-a9' LDFLAGS=-static all "
             "&& for f in flight.txt filters.txt; do [ ! -e $f ] || qemu-arm ./replay $f || "
             "exit 1; done"),
      0)
      << folder_.read("log");
}

TEST_P(FlightCodeCompiled, ForCortexMIsSmall) {
  if (!installed("arm-none-eabi-gcc")) GTEST_SKIP() << "arm-none-eabi-gcc is not installed here";
  if (GetParam().double_precision) GTEST_SKIP() << "these processors compute in float";
  const std::string name = GetParam().vehicle;
  folder_.write("size.c",
                fmt::format("#include \"{0}.h\"\nchar size[sizeof({0}_state_t)];\n", name));
  for (const char* processor :
       {"-mcpu=cortex-m4 -mfpu=fpv4-sp-d16", "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16"}) {
    ASSERT_EQ(
        run_in(folder_.path(),
               fmt::format("rm -f *.o *.ci && arm-none-eabi-gcc {} -mthumb -mfloat-abi=hard "
                           "-std=c99 -O2 -Wall -Wextra -Wdouble-promotion -Werror "
                           "-fcallgraph-info=su -c {}*.c size.c && arm-none-eabi-size -t {}*.o | "
                           "tail -n 1 && arm-none-eabi-nm -S size.o",
                           processor, name, name)),
        0)
        << folder_.read("log");
    std::istringstream said(folder_.read("log"));
    int code = 0, data = 0, zeroed = 0;
    said >> code >> data >> zeroed;
    EXPECT_GT(code, 1000);
    EXPECT_LE(code, 60'000);
    EXPECT_EQ(data + zeroed, 0);  // no state outside the structure
    std::string rest, at, bytes;
    std::getline(said, rest);
    said >> at >> bytes;
    EXPECT_GT(std::stoi(bytes, nullptr, 16), 0);
    EXPECT_LE(std::stoi(bytes, nullptr, 16), 8'000);
    CallGraph calls;
    for (const auto& file : std::filesystem::directory_iterator(folder_.path()))
      if (file.path().extension() == ".ci") calls.read(file.path());
    const int stack = calls.deepest(name + (GetParam().estimator ? "_step" : "_control"));
    EXPECT_GT(stack, 100);
    EXPECT_LE(stack, 2'500);
    EXPECT_LE(calls.deepest(name + "_initialize"), stack);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Programs, FlightCodeCompiled,
    ::testing::Values(
        FlightCodeCase{"cascade", "crazyflie", InputKind::wrench, -1, true, true},
        FlightCodeCase{"cascade_in_double", "mambo", InputKind::wrench, -1, true, true, true, true},
        FlightCodeCase{"wrench_of_past_commands", "mambo", InputKind::wrench, 3},
        FlightCodeCase{"mambo_filter", "mambo", InputKind::wrench, -1, true, true, true, false,
                       "mambo"},
        FlightCodeCase{"uquad_filter", "uquad", InputKind::wrench, -1, true, true, true, false,
                       "uquad"},
        FlightCodeCase{"uquad_filter_in_double", "uquad", InputKind::wrench, 3, true, false, true,
                       true, "uquad"},
        FlightCodeCase{"steady_filters", "uquad", InputKind::wrench, -1, true, true, false, false,
                       "", true},
        FlightCodeCase{"steady_filters_in_double", "uquad", InputKind::wrench, -1, true, true,
                       false, true, "", true},
        FlightCodeCase{"speeds", "uquad", InputKind::rotor_speed, 2, true, false, false}),
    [](const auto& of) { return of.param.name; });

/// The number of instructions that a function, or two that form a step, took in a recorded flight.
struct InstructionCount {
  double calls = 0, sum = 0, max = 0;
  [[nodiscard]] double mean() const { return sum / calls; }
};

/// A program with limits on its instructions: the mean of a step, and the maximum of the law alone.
struct Measured {
  FlightCodeCase program;
  double step, law;
};

/// A program `prog` on the processor itself, without an operating system.
class FlightCodeOnCortexM : public ::testing::TestWithParam<Measured> {
 protected:
  void SetUp() override {
    if (!installed("arm-none-eabi-gcc") || !installed("qemu-system-arm"))
      GTEST_SKIP() << "arm-none-eabi-gcc or qemu-system-arm is not installed here";
    ExportContent content = flight_code_content(GetParam().program);
    content.flight_code.name = "prog";
    write_files(folder_.path(), flight_code_files(content));
  }

  /// Replays the recorded flight on an emulated board, on which each instruction takes 2^8 ns, and
  /// counts the instructions of functions. Existing objects are linked unchanged.
  [[nodiscard]] InstructionCount replay(const std::string& board, const std::string& processor,
                                        const std::vector<std::string>& functions) const {
    const std::string flags = processor + " -mthumb -mfloat-abi=hard";
    std::string link = flags + " --specs=rdimon.specs count.o -Wl,--section-start=.vectors=0";
    for (const std::string& function : functions) link += ",--wrap=prog_" + function;
    EXPECT_EQ(run_in(folder_.path(),
                     fmt::format("arm-none-eabi-gcc {0} -std=c99 -O2 -Wall -Wextra -Werror -c "
                                 "'{1}/tests/exports/stubs/cortex_m/count.c' && rm -f replay && "
                                 "make -s CC=arm-none-eabi-gcc CFLAGS='-O2 {0}' LDFLAGS='{2}' && "
                                 "timeout 60 qemu-system-arm -M {3} -icount shift=8 -display none "
                                 "-monitor none -serial none -semihosting-config "
                                 "enable=on,target=native,arg=replay,arg=flight.txt -kernel replay",
                                 flags, testing::source_folder(), link, board)),
              0)
        << folder_.read("log");
    std::istringstream said(folder_.read("log"));
    std::string line;
    std::getline(said, line);
    EXPECT_THAT(line, HasSubstr("control periods, all equal bit by bit"));
    InstructionCount count;
    double ticks = 0;
    said >> count.calls >> count.sum >> count.max >> ticks;
    // The clock runs at 25 MHz, so 300,000 instructions are this many ticks if time is emulated.
    EXPECT_NEAR(ticks, 300'000 * 256e-9 * 25e6, 2);
    EXPECT_GT(count.calls, 400);
    return count;
  }

  const TemporaryDirectory folder_;
};

TEST_P(FlightCodeOnCortexM, RepeatsTheFlightInFewInstructions) {
  for (const auto& [board, processor] :
       {std::pair{"mps2-an386", "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16"},
        {"mps2-an500", "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16"}}) {
    ASSERT_EQ(run_in(folder_.path(), "make -s clean"), 0);
    const InstructionCount step = replay(board, processor, {"estimate", "control"});
    const InstructionCount law = replay(board, processor, {"law_step"});
    RecordProperty(board, fmt::format("step {:.0f}, at most {}; law {:.0f}, at most {}",
                                      step.mean(), step.max, law.mean(), law.max));
    EXPECT_GT(law.mean(), 500);
    EXPECT_LE(law.max, GetParam().law);
    EXPECT_GT(step.mean(), law.mean());
    EXPECT_LE(step.mean(), GetParam().step);
    EXPECT_LE(step.max, 200'000);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Programs, FlightCodeOnCortexM,
    ::testing::Values(
        Measured{{"cascade", "crazyflie", InputKind::wrench, -1, true, true}, 25'000, 1'500},
        Measured{{"mambo_filter", "mambo", InputKind::wrench, -1, true, true, true, false, "mambo"},
                 5'000,
                 1'500},
        Measured{{"feedback", "mambo", InputKind::wrench, -1, false, false, false}, 2'500, 1'500},
        Measured{{"feedback_of_past_commands", "mambo", InputKind::wrench, 3, true, false, false},
                 4'500,
                 3'000}),
    [](const auto& of) { return of.param.program.name; });

class FlightCodeByTheRules : public ::testing::TestWithParam<FlightCodeCase> {};

TEST_P(FlightCodeByTheRules, OfMisraHasNoFindingBesideTheDeviations) {
  if (!installed("cppcheck")) GTEST_SKIP() << "cppcheck is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(flight_code_content(GetParam())));
  EXPECT_EQ(run_in(folder.path(), "make -s misra"), 0) << folder.read("log");
}

INSTANTIATE_TEST_SUITE_P(
    Programs, FlightCodeByTheRules,
    ::testing::Values(
        FlightCodeCase{"cascade", "crazyflie", InputKind::wrench, -1, true, true},
        FlightCodeCase{"cascade_in_double", "mambo", InputKind::wrench, -1, true, true, true, true},
        FlightCodeCase{"mambo_filter", "mambo", InputKind::wrench, -1, true, true, true, false,
                       "mambo"},
        FlightCodeCase{"mambo_filter_in_double", "mambo", InputKind::wrench, 3, true, false, true,
                       true, "mambo"},
        FlightCodeCase{"uquad_filter", "uquad", InputKind::wrench, -1, true, true, true, false,
                       "uquad"},
        FlightCodeCase{"uquad_filter_in_double", "uquad", InputKind::wrench, 3, true, false, true,
                       true, "uquad"},
        FlightCodeCase{"cascade_alone", "uquad", InputKind::wrench, -1, true, true, false},
        FlightCodeCase{"wrench_of_past_commands", "mambo", InputKind::wrench, 3},
        FlightCodeCase{"wrench_of_lags", "crazyflie", InputKind::wrench, 0, true, false, false},
        FlightCodeCase{"wrench_without_state", "mambo", InputKind::wrench, -1, false, false, false},
        FlightCodeCase{"wrench_in_double", "uquad", InputKind::wrench, 2, true, false, true, true},
        FlightCodeCase{"steady_filters", "uquad", InputKind::wrench, -1, true, true, false, false,
                       "", true},
        FlightCodeCase{"steady_filters_in_double", "uquad", InputKind::wrench, -1, true, true,
                       false, true, "", true},
        FlightCodeCase{"speeds", "uquad", InputKind::rotor_speed, 2, true, false, false},
        FlightCodeCase{"thrusts", "mambo", InputKind::rotor_thrust, -1, true, false, false},
        FlightCodeCase{"commands", "mambo", InputKind::command, 1, true, false, false}),
    [](const auto& of) { return of.param.name; });

TEST(FlightCode, ThatBreaksRulesOfMisraIsFound) {
  if (!installed("cppcheck")) GTEST_SKIP() << "cppcheck is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(),
              flight_code_files(flight_code_content(
                  {"cascade_alone", "uquad", InputKind::wrench, -1, true, true, false})));
  const auto findings = [&](const std::string& file, const std::string& more) {
    const std::string text = folder.read(file);
    folder.write(file, text + more);
    EXPECT_NE(run_in(folder.path(), "make -s misra"), 0) << more;
    folder.write(file, text);
    return folder.read("log");
  };
  // A rule about one line, one about the whole program, and a deviation in another file.
  EXPECT_THAT(findings("uquad_motors.c",
                       "\nint uquad_early(int x);\nint uquad_early(int x) {\n"
                       "  if (x > 0) {\n    return 1;\n  }\n  return 0;\n}\n"),
              HasSubstr("misra-c2012-15.5"));
  EXPECT_THAT(findings("uquad_motors.c", "\n#define UQUAD_NEVER 1\n"),
              HasSubstr("misra-c2012-2.5"));
  EXPECT_THAT(findings("uquad_motors.c", "\n#include <stdio.h>\n"), HasSubstr("misra-c2012-20.1"));
}

class ScheduleCompiled : public ::testing::TestWithParam<ScheduleCase> {
 protected:
  void write(bool double_precision) {
    write_files(folder_.path(), flight_code_files(schedule_content_of(random_schedule(GetParam()),
                                                                      double_precision)));
  }

  const TemporaryDirectory folder_;
};

TEST_P(ScheduleCompiled, ByClangAndWithSanitizersRepeatsThePoints) {
  for (const bool double_precision : {false, true}) {
    write(double_precision);
    EXPECT_EQ(run_in(folder_.path(),
                     "make clean && make CC=cc CFLAGS='-O1 -fsanitize=undefined,address "
                     "-fno-sanitize-recover=all' LDFLAGS=-fsanitize=undefined,address test"),
              0)
        << folder_.read("log");
    if (!installed("clang")) continue;
    EXPECT_EQ(run_in(folder_.path(),
                     "make clean && make CC=clang CFLAGS='-O2 -Wconversion -Wdouble-promotion "
                     "-Wshadow -Werror' test"),
              0)
        << folder_.read("log");
  }
}

TEST_P(ScheduleCompiled, ForArmRepeatsThePoints) {
  if (!installed("arm-linux-gnueabihf-gcc") || !installed("qemu-arm"))
    GTEST_SKIP() << "arm-linux-gnueabihf-gcc or qemu-arm is not installed here";
  write(false);
  EXPECT_EQ(
      run_in(folder_.path(),
             "make CC=arm-linux-gnueabihf-gcc CFLAGS='-O2 -mcpu=cortex-a9' LDFLAGS=-static all "
             "&& qemu-arm ./replay points.txt"),
      0)
      << folder_.read("log");
}

TEST_P(ScheduleCompiled, ForCortexMHasItsTableInConstants) {
  if (!installed("arm-none-eabi-gcc")) GTEST_SKIP() << "arm-none-eabi-gcc is not installed here";
  write(false);
  ASSERT_EQ(run_in(folder_.path(),
                   "arm-none-eabi-gcc -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mthumb -mfloat-abi=hard "
                   "-std=c99 -O2 -Wall -Wextra -Wdouble-promotion -Werror -fcallgraph-info=su -c "
                   "uquad_schedule*.c && arm-none-eabi-size -A uquad_schedule.o "
                   "uquad_schedule_table.o | awk '/^\\.text/ { code += $2 } /^\\.rodata/ "
                   "{ table += $2 } /^\\.(data|bss)/ { data += $2 } "
                   "END { print code, table, data }'"),
            0)
      << folder_.read("log");
  std::istringstream said(folder_.read("log"));
  int code = 0, table = 0, data = -1;
  said >> code >> table >> data;
  EXPECT_GT(code, 200);
  EXPECT_LE(code, 2'000);
  EXPECT_THAT(folder_.read("README.md"), HasSubstr(fmt::format("{} bytes of constants", table)));
  EXPECT_EQ(data, 0);
  CallGraph calls;
  for (const auto& file : std::filesystem::directory_iterator(folder_.path()))
    if (file.path().extension() == ".ci") calls.read(file.path());
  EXPECT_GT(calls.deepest("uquad_schedule_gains"), 20);
  EXPECT_LE(calls.deepest("uquad_schedule_gains"), 600);
}

TEST_P(ScheduleCompiled, ByTheRulesOfMisraHasNoFindingBesideTheDeviations) {
  if (!installed("cppcheck")) GTEST_SKIP() << "cppcheck is not installed here";
  for (const bool double_precision : {false, true}) {
    write(double_precision);
    EXPECT_EQ(run_in(folder_.path(), "make -s misra"), 0) << folder_.read("log");
  }
}

// One value, two axes and integrals, and points without a gain.
INSTANTIATE_TEST_SUITE_P(Schedules, ScheduleCompiled,
                         ::testing::Values(schedule_cases()[2], schedule_cases()[3],
                                           schedule_cases()[5]),
                         [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace quadtune
