// SPDX-License-Identifier: Apache-2.0
// Flight code on the command line: exported, verified, flown and rejected.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using SortedJson = nlohmann::json;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

/// The Crazyflie's cascade, and flight code with it.
class FlightCodeVerb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryDirectory;
    const ProgramResult made =
        run_program({"pid", "crazyflie", "--json", "--quiet", "-o", path("gains.json")});
    ASSERT_EQ(made.status, 0) << made.err;
    const ProgramResult exported =
        run_program({"export", path("gains.json"), "--to", "c", "-o", path("code")});
    ASSERT_EQ(exported.status, 0) << exported.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }

  static TemporaryDirectory* folder_;
};
TemporaryDirectory* FlightCodeVerb::folder_ = nullptr;

TEST_F(FlightCodeVerb, VerifiesWhatItExported) {
  const ProgramResult verified = run_program({"verify", path("code"), "--json"});
  EXPECT_EQ(verified.status, 0) << verified.err;
  const SortedJson found = SortedJson::parse(verified.out);
  int of_code = 0;
  for (const SortedJson& check : found["checks"]) {
    const std::string name = check["name"];
    if (name == "C is what the gains give" || name == "the compiled program repeats its flight")
      ++of_code;
    EXPECT_TRUE(check["ok"]) << check;
  }
  EXPECT_EQ(of_code, 2);
}

TEST_F(FlightCodeVerb, FliesTheCompiledProgramAsTheLaw) {
  if (std::system("cc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "cc is not installed here";
  const std::vector<std::string> flight = {"fly",       "crazyflie", "--gains", path("code"),
                                           "--mission", "step-yaw",  "--quiet", "--json"};
  std::vector<std::string> compiled = flight;
  compiled.emplace_back("--compiled");
  const SortedJson expected = SortedJson::parse(run_program(flight).out);
  const ProgramResult flown = run_program(compiled);
  ASSERT_EQ(flown.status, 0) << flown.err;
  const SortedJson found = SortedJson::parse(flown.out);
  EXPECT_EQ(found["verdict"], "pass");
  EXPECT_THAT(std::string(found["law"]), HasSubstr("compiled flight code"));
  // In float, and with a filter that starts with a larger covariance.
  for (const char* metric : {"tracking_rms_m", "yaw_rms_rad"})
    EXPECT_NEAR(found["metrics"][metric], double(expected["metrics"][metric]), 0.02) << metric;
}

TEST_F(FlightCodeVerb, ExportsAGainScheduleThatItVerifies) {
  const std::string table = path("schedule.toml"), code = path("schedule-code");
  const ProgramResult solved =
      run_program({"lqr", "uquad", "--schedule", "speed=0:1:2, mass=0.9:0.1:1.1", "--R", "0.01",
                   "--quiet", "-o", table});
  ASSERT_EQ(solved.status, 0) << solved.err;
  const ProgramResult exported = run_program({"export", table, "--to", "c", "-o", code});
  EXPECT_EQ(exported.status, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("uquad_schedule_table.c"));
  const ProgramResult verified = run_program({"verify", code, "--design", table, "--json"});
  EXPECT_EQ(verified.status, 0) << verified.out;
  EXPECT_THAT(verified.out, HasSubstr("C is what the schedule gives"));
  EXPECT_THAT(verified.out, HasSubstr("uquad.toml, schedule.toml as listed"));
  EXPECT_THAT(verified.out, HasSubstr("schedule is that of the table"));
  // The export of another table, with the manifest of the first one.
  const std::string other = path("of-another/schedule.toml"), swapped = path("swapped");
  std::filesystem::create_directory(path("of-another"));
  ASSERT_EQ(run_program({"lqr", "uquad", "--schedule", "speed=0:1:2, mass=0.9:0.1:1.1", "--R",
                         "0.02", "--quiet", "-o", other})
                .status,
            0);
  ASSERT_EQ(run_program({"export", other, "--to", "c", "-o", swapped, "--quiet"}).status, 0);
  SortedJson manifest = SortedJson::parse(std::ifstream(swapped + "/manifest.json"));
  manifest["inputs"] = SortedJson::parse(std::ifstream(code + "/manifest.json"))["inputs"];
  std::ofstream(swapped + "/manifest.json") << manifest;
  const ProgramResult noticed = run_program({"verify", swapped, "--design", table});
  EXPECT_EQ(noticed.status, 1);
  EXPECT_THAT(noticed.out, HasSubstr("FAIL schedule is that of the table: schedule.json, line"));
  // The table in it flies.
  const ProgramResult flown =
      run_program({"fly", "uquad", "--mission", "hover", "--duration", "2", "--gains", code});
  EXPECT_THAT(flown.out, HasSubstr("schedule-code/schedule.json, 9 points")) << flown.err;

  const auto refused = [&](std::vector<std::string> words, int status, const char* message) {
    words.insert(words.begin(), {"export", table, "-o", path("none")});
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(path("none")));
  };
  refused({"--to", "json"}, 3, "is a gain schedule, expected the format c");
  refused({"--to", "c", "--law", "state-feedback"}, 2,
          "--law cannot be combined with a gain schedule");
  refused({"--to", "c", "--adapter", "px4"}, 2,
          "--adapter cannot be combined with a gain schedule");
  refused({"--to", "c", "--force"}, 2, "--force cannot be combined with a gain schedule");
  refused({"--to", "c", "--name", "9x"}, 2, "cannot be the prefix of names in C");
  refused({"--to", "c", "--precision", "half"}, 2, "no precision 'half'");
  refused({"--to", "c", "--vehicle", "mambo"}, 3, "for the vehicle 'uquad', expected 'mambo'");
  EXPECT_THAT(run_program({"export", code, "--to", "json", "-o", path("none")}).err,
              HasSubstr("has gains for many trims; expected those of one law"));
  EXPECT_THAT(run_program({"fly", "uquad", "--gains", code, "--compiled"}).err,
              HasSubstr("is the program of a gain schedule, which does not fly"));
}

// The files of the program are not identified by a prefix of their names.
TEST_F(FlightCodeVerb, NameMayBeginAsThatOfAnotherFile) {
  if (std::system("cc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "cc is not installed here";
  for (const char* name : {"replay2", "adapter_x"}) {
    const std::string out = path(name);
    ASSERT_EQ(run_program({"export", path("gains.json"), "--to", "c", "--name", name, "-o", out,
                           "--adapter", "main"})
                  .status,
              0);
    EXPECT_EQ(std::system(("make -s -C " + out + " test > /dev/null 2>&1").c_str()), 0) << name;
    EXPECT_EQ(run_program({"verify", out}).status, 0) << name;
  }
}

TEST_F(FlightCodeVerb, RefusesInOneLine) {
  const auto refused = [](const std::vector<std::string>& words, int status, const char* message) {
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, Not(HasSubstr("matches")));
  };
  const std::string gains = path("gains.json"), out = path("other");
  refused({"export", gains, "--to", "c", "-o", out, "--name", "9x"}, 2,
          "cannot be the prefix of names in C");
  refused({"export", gains, "--to", "c", "-o", out, "--precision", "half"}, 2,
          "--precision: no precision 'half', expected float or double");
  refused({"export", gains, "--to", "c", "-o", out, "--law", "state-feedback"}, 3,
          "the design has no law 'state-feedback'");
  refused({"export", gains, "--to", "json", "-o", out, "--name", "x"}, 2,
          "--name applies to the format c only, not to json");
  EXPECT_FALSE(std::filesystem::exists(out));
  refused({"fly", "crazyflie", "--compiled"}, 2, "requires --gains DIR");
  refused({"fly", "crazyflie", "--gains", gains, "--compiled"}, 2, "has no flight_code.json");
  refused({"fly", "crazyflie", "--gains", path("code"), "--compiled", "--estimator", "truth"}, 2,
          "estimator is 'truth', expected 'general', which");
  refused(
      {"fly", "crazyflie", "--gains", path("code"), "--compiled", "--controller", "state-feedback"},
      2, "expected 'cascaded-pid', which the compiled program uses, or to be omitted");
  refused({"fly", "crazyflie", "--gains", path("code"), "--arm"}, 2, "--arm requires --compiled");
  refused({"fly", "crazyflie", "--gains", path("code"), "--compiled", "--allocation", "clipped"}, 2,
          "compiled requires the default --allocation");
}

}  // namespace
}  // namespace quadtune
