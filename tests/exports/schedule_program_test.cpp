// SPDX-License-Identifier: Apache-2.0
// Gain schedules as C programs compute the same as the library.
#include "flight_code/schedule_program.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "exported_c.hpp"
#include "numbers.hpp"
#include "plants/schedules.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/flight_code_check.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/exports/verify.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using exports::ScheduleProgram;
using exports::ScheduleStatus;
using testing::has_compiler;
using ::testing::HasSubstr;
using testing::kInfinity;
using testing::kNaN;
using testing::make_test;
using testing::random_schedule;
using testing::schedule_cases;
using testing::schedule_content_of;
using testing::ScheduleCase;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

/// A schedule of K = (v + 10 r + 100 v r, 1), which multilinear interpolation reproduces exactly.
GainSchedule bilinear_schedule() {
  GainSchedule schedule = random_schedule(
      {"bilinear",
       {{ScheduleQuantity::speed, {0, 1, 4}}, {ScheduleQuantity::yaw_rate, {-1, 1}}},
       2,
       1});
  for (Eigen::Index i = 0; i < schedule.size(); ++i) {
    const Eigen::VectorXd at = grid_point(schedule.axes, i);
    schedule.K.col(i) << at(0) + 10 * at(1) + 100 * at(0) * at(1), 1;
    schedule.x0.col(i) << at(0), 0;
    schedule.u0.col(i) << at(1);
  }
  return schedule;
}

/// Within and beyond the grid, on its edges and on its points.
Eigen::VectorXd drawn_point(const GainSchedule& schedule, std::mt19937_64& random) {
  Eigen::VectorXd at(std::ssize(schedule.axes));
  for (Eigen::Index a = 0; a < at.size(); ++a) {
    const std::vector<double>& axis = schedule.axes[static_cast<std::size_t>(a)].values;
    const double span = axis.back() - axis.front() + 0.1;
    at(a) = random() % 3 == 0 ? axis[random() % axis.size()]
                              : std::uniform_real_distribution<double>(
                                    axis.front() - 0.2 * span, axis.back() + 0.2 * span)(random);
  }
  return at;
}

class ScheduleCode : public ::testing::TestWithParam<ScheduleCase> {};

TEST_P(ScheduleCode, RepeatsTheLibrarysTemplateBitByBit) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const GainSchedule schedule = random_schedule(GetParam());
  for (const bool double_precision : {false, true}) {
    const TemporaryDirectory folder;
    write_files(folder.path(), flight_code_files(schedule_content_of(schedule, double_precision)));
    folder.write("points.txt", exports::recorded_points(schedule, double_precision, 3000));
    EXPECT_EQ(make_test(folder.path()), 0) << folder.read("log");
    EXPECT_THAT(folder.read("log"), HasSubstr("points, all equal bit by bit"));
  }
}

TEST_P(ScheduleCode, HasATemplateThatIsTheLibrarysInDouble) {
  const GainSchedule schedule = random_schedule(GetParam());
  ScheduleProgram<double> program(schedule);
  std::mt19937_64 random(1);
  int found = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::VectorXd at = drawn_point(schedule, random);
    Eigen::VectorXd nearest = at;
    for (Eigen::Index a = 0; a < at.size(); ++a) {
      const std::vector<double>& axis = schedule.axes[static_cast<std::size_t>(a)].values;
      nearest(a) = std::clamp(at(a), axis.front(), axis.back());
    }
    const Eigen::MatrixXd before = program.K;
    const ScheduleStatus status = program.look_up(at);
    const ScheduledGain expected = schedule.at(nearest);
    if (!expected.found()) {
      EXPECT_EQ(expected.status, LookupStatus::infeasible);
      EXPECT_EQ(status, ScheduleStatus::no_gain);
      EXPECT_EQ(program.K, before);
      continue;
    }
    ++found;
    EXPECT_EQ(status, at == nearest ? ScheduleStatus::found : ScheduleStatus::nearest);
    EXPECT_EQ(program.K, expected.K);
    EXPECT_EQ(program.K_int, expected.K_int);
    EXPECT_EQ(program.x0, expected.x0);
    EXPECT_EQ(program.u0, expected.u0);
  }
  EXPECT_GT(found, 1000);
}

TEST_P(ScheduleCode, InFloatIsTheLibrarysToRounding) {
  const GainSchedule schedule = random_schedule(GetParam());
  ScheduleProgram<float> in_float(schedule);
  ScheduleProgram<double> in_double(schedule);
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::VectorXd at = drawn_point(schedule, random);
    // The two may disagree whether a value is exactly on a point of the grid.
    if (in_float.look_up(at.cast<float>()) == ScheduleStatus::no_gain) continue;
    if (in_double.look_up(at) == ScheduleStatus::no_gain) continue;
    EXPECT_LT((in_float.K.cast<double>() - in_double.K).cwiseAbs().maxCoeff(), 2e-5);
    EXPECT_LT((in_float.u0.cast<double>() - in_double.u0).cwiseAbs().maxCoeff(), 2e-5);
  }
}

TEST_P(ScheduleCode, HasAConstantBoundForEachLoop) {
  for (const FileContent& file :
       flight_code_files(schedule_content_of(random_schedule(GetParam()), false)))
    if (file.name == "uquad_schedule.c" || file.name == "uquad_schedule_arithmetic.h") {
      EXPECT_THAT(testing::loops_without_bound(file.bytes), ::testing::IsEmpty()) << file.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Schedules, ScheduleCode, ::testing::ValuesIn(schedule_cases()),
                         [](const auto& of) { return of.param.name; });

TEST(ScheduleCode, FollowsTheFormulas) {
  ScheduleProgram<double> program(bilinear_schedule());
  using Vector = Eigen::VectorXd;
  for (const double v : {0.0, 0.3, 1.0, 1.7, 4.0})
    for (const double r : {-1.0, -0.2, 1.0}) {
      ASSERT_EQ(program.look_up(Eigen::Vector2d(v, r)), ScheduleStatus::found);
      EXPECT_NEAR(program.K(0, 0), v + 10 * r + 100 * v * r, 1e-12);
      EXPECT_NEAR(program.x0(0), v, 1e-14);
      const Vector u = program.inputs(Eigen::Vector2d(3, 5), Eigen::Vector2d(1, 7), Vector(0));
      EXPECT_NEAR(u(0), r + 2 * program.K(0, 0) - 2, 1e-12);
    }
}

TEST(ScheduleCode, CountsValuesBeyondTheGridAsItsEdge) {
  ScheduleProgram<double> program(bilinear_schedule());
  ASSERT_EQ(program.look_up(Eigen::Vector2d(9, -0.5)), ScheduleStatus::nearest);
  EXPECT_NEAR(program.K(0, 0), 4 - 5 - 200, 1e-12);
}

TEST(ScheduleCode, KeepsTheGainsWhereAValueIsNotFinite) {
  ScheduleProgram<float> program(bilinear_schedule());
  ASSERT_EQ(program.look_up(Eigen::Vector2f(1, 1)), ScheduleStatus::found);
  const Eigen::MatrixXf K = program.K;
  for (const double none : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(program.look_up(Eigen::Vector2f(0, static_cast<float>(none))),
              ScheduleStatus::not_finite);
    EXPECT_EQ(program.K, K);
  }
}

TEST(ScheduleCode, ThatIsChangedDoesNotRepeatThePoints) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const std::pair<const char*, const char*> changes[] = {
      {"at_upper ? share[a] : (1.0f - share[a])", "at_upper ? (1.0f - share[a]) : share[a]"},
      {"(sp[j] - x[j])", "(x[j] - sp[j])"},
      {"x >= axis[i]", "x <= axis[i]"},
      {"uquad_schedule_clamp(values[a], axis[0], axis[last])", "values[a]"}};
  for (const auto& [from, to] : changes) {
    const TemporaryDirectory folder;
    write_files(folder.path(), flight_code_files(schedule_content_of(
                                   random_schedule(schedule_cases()[3]), false)));
    std::string code = folder.read("uquad_schedule.c");
    const std::size_t at = code.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    folder.write("uquad_schedule.c", code.replace(at, std::string(from).size(), to));
    EXPECT_NE(make_test(folder.path()), 0) << from;
    EXPECT_THAT(folder.read("log"), HasSubstr("expected")) << from;
  }
}

TEST(ScheduleCode, ReplaysNothingThatIsNoRecording) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(schedule_content_of(bilinear_schedule(), false)));
  ASSERT_EQ(make_test(folder.path()), 0) << folder.read("log");
  const auto replayed = [&](const std::string& text) {
    folder.write("other.txt", text);
    return WEXITSTATUS(std::system(
        fmt::format("cd '{}' && ./replay other.txt > other.log 2>&1", folder.path().string())
            .c_str()));
  };
  EXPECT_EQ(replayed(""), 2);
  EXPECT_EQ(replayed("# nothing\n"), 2);
  EXPECT_EQ(replayed("0 1 2\n"), 2);
  EXPECT_EQ(replayed("words\n"), 2);
}

TEST(ScheduleCode, MayHaveANameLikeThoseOfTheSources) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  GainSchedule schedule = bilinear_schedule();
  schedule.states[0] = {"*/ #error /*", "*/"};  // must not end a comment
  ExportContent content = schedule_content_of(schedule, false);
  content.flight_code.name = "qt_real";
  write_files(folder.path(), flight_code_files(content));
  EXPECT_EQ(make_test(folder.path()), 0) << folder.read("log");
}

TEST(ScheduleCode, IsNamedAfterTheVehicle) {
  ExportContent content = schedule_content_of(bilinear_schedule(), false);
  EXPECT_EQ(exports::schedule_program_name(content), "uquad_schedule");
  content.vehicle.name = "A vehicle of a very long name";
  EXPECT_EQ(exports::schedule_program_name(content), "a_vehicle_of_a__schedule");
}

TEST(ScheduleCode, RefusesWhatIsNoProgram) {
  const auto refusal = [](const auto& change, const char* message) {
    ExportContent content = schedule_content_of(bilinear_schedule(), false);
    change(content);
    EXPECT_THAT([&] { (void)flight_code_files(content); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal([](ExportContent& c) { c.schedule->K(0, 1) = 1e39; },
          "schedule at speed 0, yaw_rate 1: K: is 1e+39, expected at most 3.4e38");
  refusal([](ExportContent& c) { c.schedule->u0(0, 0) = -1e39; }, "u0: is -1e+39");
  refusal([](ExportContent& c) { c.schedule->axes[0].values[2] = 1e39; }, "speed: is 1e+39");
  refusal([](ExportContent& c) { c.schedule->axes[0].values[2] = 1 + 1e-12; },
          "speed has 1.000000000001 after 1, which are the same number in float");
  refusal(
      [](ExportContent& c) {
        for (PointStatus& status : c.schedule->status) status = PointStatus::no_gain;
      },
      "has no gain at any of its points");
  refusal([](ExportContent& c) { c.flight_code.law = "state-feedback"; },
          "the law 'state-feedback' cannot be exported with a gain schedule");
  refusal([](ExportContent& c) { c.flight_code.adapter = "px4"; },
          "the adapter 'px4' cannot be exported");
  for (const char* name : {"int", "9a", "a-b", "replay", "replay_lines"})
    refusal([&](ExportContent& c) { c.flight_code.name = name; },
            "cannot be the prefix of names in C");
  // In double both are numbers.
  ExportContent content = schedule_content_of(bilinear_schedule(), true);
  content.schedule->K(0, 1) = 1e39;
  content.schedule->axes[0].values[2] = 1 + 1e-12;
  EXPECT_NO_THROW((void)flight_code_files(content));
  // Other exporters do not support schedules.
  EXPECT_THAT([&] { (void)export_files(ExportKind::json, content); },
              ThrowsMessage<InvalidInput>(HasSubstr("'json' cannot hold a gain schedule")));
}

TEST(ScheduleCode, IsVerifiedByItsText) {
  const TemporaryDirectory folder;
  const ExportContent content = schedule_content_of(random_schedule(schedule_cases()[5]), false);
  (void)write_export(folder.path(), ExportKind(kFlightCodeTarget), content);
  EXPECT_TRUE(verify_export(folder.path(), {}).ok());
  const auto check = [&] { return flight_code_checks(folder.path(), content.vehicle, {}).front(); };
  EXPECT_TRUE(check().ok) << check().detail;
  EXPECT_EQ(check().name, "C is what the schedule gives");
  folder.write("other_table.c", "");
  EXPECT_THAT(check().detail, HasSubstr("other_table.c belongs to another program"));
  std::filesystem::remove(folder.path() / "other_table.c");
  const GainSchedule schedule = read_schedule(folder.path() / kScheduleJsonName);
  std::mt19937_64 random(1);
  for (const ManifestFile& file : read_manifest(folder.path()).files)
    for (int i = 0; i < 10; ++i) {
      const std::string text = folder.read(file.path);
      std::string changed = text;
      changed[random() % changed.size()] ^= 1;
      folder.write(file.path, changed);
      EXPECT_FALSE(verify_export(folder.path(), {}).ok()) << file.path;
      if (check().ok) {
        // The residual and the reason of a point are in no other file.
        const GainSchedule now = read_schedule(folder.path() / kScheduleJsonName);
        EXPECT_TRUE(now.residual != schedule.residual || now.culprit != schedule.culprit)
            << file.path;
      }
      folder.write(file.path, text);
    }
  EXPECT_TRUE(check().ok) << check().detail;
}

}  // namespace
}  // namespace quadtune
