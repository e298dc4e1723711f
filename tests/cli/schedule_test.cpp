// SPDX-License-Identifier: Apache-2.0
/// quadtune lqr V --schedule GRID.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/workbench/schedule/schedule_axes.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

constexpr char kGrid[] = "speed=0:4:8, yaw_rate=-2:2:2, mass=0.9:0.1:1.1";

TEST(ScheduleGrid, StepsMeetTheLastValueAndZero) {
  const std::vector<ScheduleAxis> axes =
      schedule_axes(" yaw_rate = -0.3:0.1:0.3,mass=0.9:0.05:1.1 , density=1", "--schedule");
  ASSERT_EQ(axes.size(), 3u);
  EXPECT_THAT(axes[0].values, ElementsAre(-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3));
  EXPECT_THAT(axes[1].values, ElementsAre(0.9, 0.95, 1, 1.05, 1.1));
  EXPECT_THAT(axes[2].values, ElementsAre(1));
  EXPECT_THAT(schedule_axes("speed=2:1:2", "--schedule")[0].values, ElementsAre(2));
}

TEST(Schedule, SummaryNamesGridAndInfeasibleCorners) {
  const ProgramResult result = run_program({"lqr", "uquad", "--schedule", kGrid});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("speed     0 ... 8 m/s, 3 values"));
  EXPECT_THAT(result.out, HasSubstr("points      27, 21 solved"));
  EXPECT_THAT(result.out, HasSubstr("6 points, the first at speed 8, yaw_rate -2, mass 0.9"));
  EXPECT_THAT(result.err, HasSubstr("lqr: warning: 6 of 27 points: no trim, e.g. at speed 8"));
  EXPECT_THAT(result.err, HasSubstr("axes that turn with the heading"));
}

TEST(Schedule, QuietSaysNothingBeside) {
  const ProgramResult result = run_program({"lqr", "uquad", "--schedule", kGrid, "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
}

TEST(Schedule, BytesAreThoseOfAnyNumberOfThreads) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second run";
  const std::vector<std::string> args = {"lqr", "uquad", "--schedule", kGrid, "--json"};
  const ProgramResult one =
      run_program({"lqr", "uquad", "--schedule", kGrid, "--json", "--threads", "1"});
  ASSERT_EQ(one.status, 0);
  EXPECT_EQ(run_program(args).out, one.out);
  for (const char* threads : {"2", "3", "7"})
    EXPECT_EQ(
        run_program({"lqr", "uquad", "--schedule", kGrid, "--json", "--threads", threads}).out,
        one.out);
}

/// The gain that `quadtune lqr` computes for the same point.
void expect_single(const GainSchedule& schedule, const Eigen::VectorXd& at,
                   std::vector<std::string> args) {
  args.insert(args.begin(), {"lqr", "uquad", "--json", "--plant", "ideal", "--integral", "pz"});
  const ProgramResult single = run_program(args);
  ASSERT_EQ(single.status, 0) << single.err;
  const nlohmann::json K = nlohmann::json::parse(single.out).at("K");
  const ScheduledGain gain = schedule.at(at);
  ASSERT_TRUE(gain.found()) << gain.culprit;
  for (Eigen::Index i = 0; i < gain.K.rows(); ++i)
    for (Eigen::Index j = 0; j < gain.K.cols(); ++j)
      EXPECT_NEAR(gain.K(i, j), K.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)),
                  1e-9 * gain.K.norm());
}

TEST(Schedule, TablesOfBothFormatsHoldTheSingleSolves) {
  const TemporaryDirectory folder;
  GainSchedule tables[2];
  int read = 0;
  for (const char* name : {"k.toml", "k.json"}) {
    const std::string path = (folder.path() / name).string();
    const ProgramResult result =
        run_program({"lqr", "uquad", "--integral", "pz", "--schedule",
                     "speed=0:1:1, climb=0:0.5:0.5, yaw_rate=-1:1:1", "-o", path});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out, "");
    tables[read++] = read_schedule(path);
  }
  EXPECT_EQ(tables[0].K, tables[1].K);
  EXPECT_EQ(tables[0].K_int, tables[1].K_int);
  const GainSchedule& schedule = tables[0];
  expect_single(schedule, Eigen::Vector3d(0, 0, 0), {});
  expect_single(schedule, Eigen::Vector3d(0, 0.5, 0), {"--at", "line", "--climb", "0.5"});
  expect_single(schedule, Eigen::Vector3d(0, 0, -1), {"--at", "spin", "--yaw-rate", "-1"});
  expect_single(schedule, Eigen::Vector3d(1, 0.5, 1),
                {"--at", "circle", "--speed", "1", "--radius", "1", "--climb", "0.5"});
}

TEST(Schedule, JsonIsTheTable) {
  const ProgramResult result =
      run_program({"lqr", "uquad", "--schedule", "mass=0.9:0.1:1.1", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const GainSchedule schedule = parse_schedule(result.out, "out", TableFormat::json);
  EXPECT_EQ(schedule.size(), 3);
  EXPECT_EQ(schedule.solved_count(), 3);
}

TEST(Schedule, WithoutAnySolutionNamesTheCulprit) {
  const ProgramResult result =
      run_program({"lqr", "uquad", "--schedule", "speed=8, yaw_rate=2:1:3", "--json"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("no point of the schedule has a gain: 2 of 2 points: no trim"));
  EXPECT_THAT(result.out, Not(HasSubstr("format_version")));
}

/// A flyable schedule of the Mambo with the wrench as input.
std::string write_schedule(const TemporaryDirectory& folder, const std::string& name,
                           const std::string& grid) {
  std::string path = (folder.path() / name).string();
  const ProgramResult result =
      run_program({"lqr", "mambo", "--schedule", grid, "--inputs", "wrench", "--Q",
                   "4,4,40,2,2,4,2,2,10,0.1,0.1,0.4", "--R", "40,8000,8000,20000", "-o", path});
  EXPECT_EQ(result.status, 0) << result.err;
  return path;
}

TEST(Schedule, Flies) {
  const TemporaryDirectory folder;
  const std::string path =
      write_schedule(folder, "k.toml", "speed=0:0.25:1, yaw_rate=-0.6:0.3:0.6");
  const ProgramResult result =
      run_program({"fly", "mambo", "--mission", "circle", "--gains", path, "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["verdict"], "pass") << json;
  // With only the gains at hover and without the trims of the circle, the yaw lags by 0.17 rad.
  EXPECT_LT(json["metrics"]["yaw_max_rad"], 0.02);
  EXPECT_THAT(json["law"].get<std::string>(), HasSubstr("gain schedule of "));
  EXPECT_THAT(json["law"].get<std::string>(), HasSubstr("k.toml, 25 points"));
}

TEST(Schedule, IsRefusedWhereOneLawIsAsked) {
  const TemporaryDirectory folder;
  const std::string path = write_schedule(folder, "k.json", "speed=0:1:1");
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"diff", path, path}, {"margins", "mambo", "--gains", path}}) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 3) << args[0] << result.err;
    EXPECT_THAT(result.err,
                HasSubstr("k.json: has gains for many trims; expected those of one law; this is "
                          "a gain schedule, which is for quadtune fly --gains"));
  }
  const ProgramResult cascade =
      run_program({"fly", "mambo", "--gains", path, "--controller", "pid"});
  EXPECT_EQ(cascade.status, 3);
  EXPECT_THAT(cascade.err, HasSubstr("is a gain schedule of a state feedback, not a PID cascade"));
  const ProgramResult other = run_program({"fly", "uquad", "--gains", path});
  EXPECT_EQ(other.status, 3);
  EXPECT_THAT(other.err, HasSubstr("the gains are for the vehicle 'mambo', expected 'uquad'"));
}

TEST(Schedule, WithoutAGainWhereTheFlightBeginsIsRefused) {
  const TemporaryDirectory folder;
  const std::string path = write_schedule(folder, "k.toml", "speed=0:1:1");
  std::string text = folder.read("k.toml");
  const std::string solved = "status = \"solved\"";
  const std::size_t first = text.find(solved);
  ASSERT_NE(first, std::string::npos);
  // The first point without its gains.
  const std::size_t end = text.find("[[point]]", first);
  text.replace(first, end - first, "status = \"no gain\"\nculprit = \"a test\"\n\n");
  (void)folder.write("k.toml", text);
  const ProgramResult result = run_program({"fly", "mambo", "--gains", path});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("k.toml: schedule: has no gain at speed 0, where a flight "
                                    "begins: no gain at speed 0: a test"));
}

}  // namespace
}  // namespace quadtune
