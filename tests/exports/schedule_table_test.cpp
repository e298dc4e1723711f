// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/schedule_table.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>

#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Numbers that an imprecise writer would change, and a point without a gain.
GainSchedule sample(bool integrals = true) {
  std::vector<Signal> integrated;
  if (integrals) integrated = {{"x", "m s"}};
  GainSchedule schedule = empty_schedule(
      {{ScheduleQuantity::speed, {0, 1.0 / 3, 2}}, {ScheduleQuantity::mass, {0.9, 1}}},
      {{"x", "m"}, {"v", "m/s"}}, {{"w1", "rad/s"}, {"w2", "rad/s"}}, integrated);
  schedule.vehicle = "uquad";
  schedule.convention = "uquad";
  schedule.input_kind = InputKind::command;
  schedule.sign_law = SignLaw::state_minus_set_point;
  schedule.dt = 0.01;
  schedule.yaw = -0.1;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (Eigen::Index i = 0; i < schedule.size(); ++i) {
    const auto p = static_cast<std::size_t>(i);
    if (i == 3) {
      schedule.status[p] = PointStatus::no_trim;
      schedule.culprit[p] = "a tilt of 45.5° \"and\" a back\\slash";
      continue;
    }
    schedule.status[p] = PointStatus::solved;
    for (Eigen::MatrixXd* M : {&schedule.K, &schedule.K_int, &schedule.x0, &schedule.u0})
      for (Eigen::Index r = 0; r < M->rows(); ++r) (*M)(r, i) = normal(random);
    schedule.residual(i) = 1e-16 / 3;
  }
  schedule.K(0, 0) = -0.0;
  schedule.K(1, 0) = std::numeric_limits<double>::denorm_min();
  schedule.K(2, 0) = 1e22;
  schedule.K(3, 0) = 123456789;
  return schedule;
}

/// Equal including the sign of zero; NaN where there is no gain.
void expect_same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      if (std::isnan(b(i, j))) {
        EXPECT_TRUE(std::isnan(a(i, j)));
        continue;
      }
      EXPECT_EQ(a(i, j), b(i, j));
      EXPECT_EQ(std::signbit(a(i, j)), std::signbit(b(i, j)));
    }
}

class ScheduleTable : public ::testing::TestWithParam<TableFormat> {
 protected:
  [[nodiscard]] std::string text(bool integrals = true) const {
    return schedule_text(sample(integrals), GetParam());
  }
  /// Checks that the sample with `from` replaced by `to` is rejected with this message.
  void refuses(const std::string& from, const std::string& to, const std::string& why) const {
    std::string broken = text();
    const std::size_t at = broken.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    broken.replace(at, from.size(), to);
    EXPECT_THAT([&] { (void)parse_schedule(broken, "table", GetParam()); },
                ThrowsMessage<InvalidInput>(HasSubstr(why)))
        << from << " -> " << to;
  }
  [[nodiscard]] bool toml() const { return GetParam() == TableFormat::toml; }
};

TEST_P(ScheduleTable, ReadsBackToTheSameDoubles) {
  for (const bool integrals : {true, false}) {
    const GainSchedule before = sample(integrals);
    const GainSchedule after = parse_schedule(text(integrals), "table", GetParam());
    EXPECT_EQ(after.axes, before.axes);
    EXPECT_EQ(after.states, before.states);
    EXPECT_EQ(after.inputs, before.inputs);
    EXPECT_EQ(after.integrals, before.integrals);
    EXPECT_EQ(after.vehicle, before.vehicle);
    EXPECT_EQ(after.convention, before.convention);
    EXPECT_EQ(after.input_kind, before.input_kind);
    EXPECT_EQ(after.sign_law, before.sign_law);
    EXPECT_EQ(after.dt, before.dt);
    EXPECT_EQ(after.yaw, before.yaw);
    EXPECT_EQ(after.status, before.status);
    EXPECT_EQ(after.culprit, before.culprit);
    expect_same(after.K, before.K);
    expect_same(after.K_int, before.K_int);
    expect_same(after.x0, before.x0);
    expect_same(after.u0, before.u0);
    expect_same(after.residual, before.residual);
    EXPECT_EQ(schedule_text(after, GetParam()), text(integrals));
  }
}

TEST_P(ScheduleTable, IsReadByItsName) {
  const testing::TemporaryDirectory folder;
  const auto path = folder.write(toml() ? "k.toml" : "k.json", text());
  expect_same(read_schedule(path).K, sample().K);
}

TEST_P(ScheduleTable, RefusesNumbersThatAreNone) {
  GainSchedule schedule = sample();
  schedule.K(0, 1) = std::nan("");
  EXPECT_THAT([&] { (void)schedule_text(schedule, GetParam()); },
              ThrowsMessage<InvalidInput>(HasSubstr("K")));
}

TEST_P(ScheduleTable, RefusesAnotherFormat) {
  refuses("quadtune-gain-schedule", "quadtune-gains", "expected 'quadtune-gain-schedule'");
  refuses(toml() ? "format_version = 1" : "\"format_version\": 1",
          toml() ? "format_version = 2" : "\"format_version\": 2", "format_version is 2");
}

TEST_P(ScheduleTable, RefusesAnotherGrid) {
  refuses("\"speed\"", "\"sped\"", "did you mean 'speed'?");
  refuses("\"mass\"", "\"speed\"", "unit of speed");
  refuses("[0.9, 1", "[1.9, 1", "mass has 1 after 1.9, expected ascending");
  refuses("[0.9, 1", "[0.8, 1", "is at speed 0, mass 0.9, expected speed 0, mass 0.8");
  refuses("[0.9, 1", "[0.9, 0.95, 1", "has 6 points, expected 9");
}

TEST_P(ScheduleTable, RefusesOtherShapes) {
  refuses("-0.0, 1e+22", "-0.0", toml() ? "row 2 of K" : "K[1]");
  refuses("\"no trim\"", "\"no trimm\"", "'no trimm', expected solved, no trim or no gain");
  refuses("\"no trim\"", "\"solved\"", toml() ? "" : "residual");
  refuses("\"command\"", "\"comand\"", "comand");
  refuses("123456789.0", "\"123\"", toml() ? "K" : "K[1][1]");
}

TEST_P(ScheduleTable, RefusesWhatIsCutShort) {
  const std::string whole = text();
  for (std::size_t length = 0; length + 3 < whole.size(); length += 37)
    EXPECT_THROW((void)parse_schedule(whole.substr(0, length), "table", GetParam()), InvalidInput)
        << length;
}

INSTANTIATE_TEST_SUITE_P(Formats, ScheduleTable,
                         ::testing::Values(TableFormat::toml, TableFormat::json),
                         [](const auto& format) {
                           return format.param == TableFormat::toml ? "Toml" : "Json";
                         });

/// Errors name the line.
TEST(ScheduleTomlTable, RefusesWithTheLine) {
  const std::string text = schedule_text(sample(), TableFormat::toml);
  const auto refuses = [&](const std::string& from, const std::string& to, const std::string& why) {
    std::string broken = text;
    const std::size_t at = broken.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
    broken.replace(at, from.size(), to);
    EXPECT_THAT(
        [&] { (void)parse_schedule(broken, "k.toml", TableFormat::toml); },
        ThrowsMessage<InvalidInput>(::testing::AllOf(
            ::testing::StartsWith("k.toml:" + std::to_string(line) + ":"), HasSubstr(why))));
  };
  refuses("dt_s = 0.01", "dt_ms = 10", "expected 'dt_s'");
  refuses("dt_s = 0.01", "dt_s = -0.01", "dt_s is -0.01");
  refuses("dt_s = 0.01", "dt_s = nan", "dt_s is nan");
  refuses("residual = ", "residuum = ", "did you mean 'residual'?");
  refuses("convention = \"uquad\"", "convention = \"uqad\"", "uqad");
  refuses("unit = \"m/s\"\nvalues", "unit = \"km/h\"\nvalues", "unit of speed is 'km/h'");
}

TEST_P(ScheduleTable, RefusesAConventionWhoseDefinitionItCannotHold) {
  Convention own = convention("uquad", "test");
  own.name = "of-a-file";
  GainSchedule schedule = sample();
  schedule.convention = add_convention(own, "test").name;
  EXPECT_THAT([&] { (void)schedule_text(schedule, GetParam()); },
              ThrowsMessage<InvalidInput>(
                  "schedule: uses the convention 'of-a-file', which is defined in a file; expected "
                  "a built-in convention because a table cannot hold a definition"));
}

TEST(ScheduleTableFormat, IsThatOfTheName) {
  EXPECT_EQ(table_format("a/b.toml", "-o"), TableFormat::toml);
  EXPECT_EQ(table_format("b.json", "-o"), TableFormat::json);
  EXPECT_THAT([] { (void)table_format("a.toml/b.txt", "-o"); },
              ThrowsMessage<InvalidInput>("-o: cannot determine the format from 'b.txt'; expected "
                                          "a file name that ends in .toml or .json"));
}

}  // namespace
}  // namespace quadtune
