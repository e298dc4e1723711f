// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/record_of_log.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::IsNan;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

LogSeries series(const std::string& name, const std::string& unit, Samples time, Samples values) {
  return {name, unit, true, std::move(time), std::move(values)};
}

std::vector<double> row(const Eigen::MatrixXd& M, Eigen::Index i) {
  std::vector<double> result;
  for (Eigen::Index k = 0; k < M.cols(); ++k) result.push_back(M(i, k));
  return result;
}

// A sonar at half the rate of the accelerometer, and a little late in its stamps.
TEST(RecordOfLog, PutsClocksTogether) {
  const FilterModel model = load_filter_model("altitude");
  const auto records =
      records_of_log(model,
                     {{"az", series("imu.az", "m/s^2", {0, 0.1, 0.2, 0.3}, {1, 2, 3, 4})},
                      {"height", series("sonar", "m", {0.1, 0.25}, {7, 8})}},
                     "a.csv");
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].name, "a.csv");
  ASSERT_EQ(records[0].time.size(), 5u);
  EXPECT_NEAR(records[0].time[3], 0.25, 1e-12);
  EXPECT_THAT(row(records[0].u, 0), ElementsAre(1, 2, 3, 3, 4));
  EXPECT_THAT(row(records[0].y, 0), ElementsAre(IsNan(), 7, IsNan(), 8, IsNan()));
}

TEST(RecordOfLog, MovesLateSamplesToWhenTheyWereTaken) {
  FilterModel model = load_filter_model("altitude");
  model.sensors[0].delay = 0.1;
  const auto records = records_of_log(model,
                                      {{"az", series("az", "", {0, 0.1, 0.2}, {1, 2, 3})},
                                       {"height", series("h", "", {0.1, 0.2, 0.3}, {7, 8, 9})}},
                                      "a.csv");
  EXPECT_THAT(row(records[0].y, 0), ElementsAre(7, 8, 9));
}

TEST(RecordOfLog, BeginsWithItsInputsAndEndsWhereTheyStayAway) {
  const FilterModel model = load_filter_model("altitude");
  Samples times, values;
  for (int k = 0; k < 40; ++k) {
    times.push_back(1 + 0.1 * k + (k < 20 ? 0 : 5));
    values.push_back(k);
  }
  Samples heights_at, heights;
  for (int k = 0; k < 12; ++k) {
    heights_at.push_back(k);
    heights.push_back(-k);
  }
  const auto records = records_of_log(
      model,
      {{"az", series("az", "", times, values)}, {"height", series("h", "", heights_at, heights)}},
      "a.csv");
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].time.front(), 1);
  EXPECT_NEAR(records[0].time.back(), 3, 1e-9);  // held from 2.9 on, not until 4
  EXPECT_NEAR(records[1].time.front(), 8, 1e-9);
  EXPECT_TRUE(records[0].u.allFinite() && records[1].u.allFinite());
}

TEST(RecordOfLog, CountsThePeriodsOfADiscreteModel) {
  FilterModel model = load_filter_model("local-level");
  model.dt = 0.1;
  const auto records =
      records_of_log(model, {{"y", series("y", "", {5, 5.1004, 5.2996, 5.4}, {1, 2, 3, 4})}}, "a");
  ASSERT_EQ(records[0].time.size(), 4u);
  EXPECT_NEAR(records[0].time[2], 5.3, 1e-12);
  EXPECT_NO_THROW(validate(records[0], model, "a"));
}

TEST(RecordOfLog, SaysWhatIsMissingOrWrong) {
  const FilterModel model = load_filter_model("altitude");
  const LogSeries some = series("c", "", {0, 1}, {1, 2});
  const auto refused = [&](const std::vector<ChannelUse>& uses, const std::string& message) {
    EXPECT_THAT([&] { (void)records_of_log(model, uses, "a.csv"); },
                ThrowsMessage<InvalidInput>(StrEq(message)));
  };
  refused({{"height", some}},
          "a.csv: the model 'altitude' needs its input 'az', expected a channel for it");
  refused({{"az", some}},
          "a.csv: no measurement of the model 'altitude' is given, expected one of height");
  refused({{"az", some}, {"heigth", some}},
          "a.csv: the model 'altitude' has no 'heigth', expected one of az, height; did you mean "
          "'height'?");
  refused({{"az", some}, {"az", some}}, "a.csv: 'az' is given twice, expected once");
  refused(
      {{"az", series("c", "", {0, 0.1}, {1, 2})}, {"height", series("h", "", {5, 6}, {1, 2})}},
      "a.csv: no measurement lies in the interval that all inputs cover, expected at least one");
  refused({{"az", some}, {"height", series("h", "", {0, 1e12}, {1, 2})}},
          "a.csv: 'h' has a sample 1e+12 s after the first sample of all channels, expected less "
          "than 4e+11 s "
          "because instants are resolved to 1e-07 s");
  FilterModel discrete = load_filter_model("local-level");
  discrete.dt = 1;
  EXPECT_THAT(
      [&] {
        (void)records_of_log(discrete, {{"y", series("y", "", {0, 1, 1.2}, {1, 2, 3})}}, "a.csv");
      },
      ThrowsMessage<InvalidInput>(StrEq(
          "a.csv: two samples of 'y' at 1 s fall into one period of 1 s, expected one because "
          "the model is discrete")));
}

TEST(RecordOfLog, InterpolatesATruthButNotOverItsGaps) {
  const FilterModel model = load_filter_model("constant-velocity");
  Samples times, values;
  for (int k = 0; k < 60; ++k) {
    times.push_back(0.1 * k);
    values.push_back(k);
  }
  const LogSeries truth =
      series("v", "m/s", {0.05, 0.25, 0.45, 0.65, 5.05, 5.25}, {1, 3, 5, 7, 70, 72});
  const auto records = records_of_log(model, {{"position", series("p", "m", times, values)}},
                                      "a.csv", {{"velocity", truth}});
  ASSERT_EQ(records.size(), 1);
  const std::vector<double> known = row(records[0].truth, 1);
  EXPECT_THAT(known[0], IsNan());
  EXPECT_NEAR(known[1], 1.5, 1e-12);
  EXPECT_NEAR(known[6], 6.5, 1e-12);
  EXPECT_THAT(known[20], IsNan());
  EXPECT_NEAR(known[52], 71.5, 1e-9);
  EXPECT_THAT(known[53], IsNan());
  EXPECT_THAT(row(records[0].truth, 0), ::testing::Each(IsNan()));
  EXPECT_THAT(
      [&] {
        (void)records_of_log(model, {{"position", series("p", "m", times, values)}}, "a.csv",
                             {{"speed", truth}});
      },
      ThrowsMessage<InvalidInput>(
          StrEq("truth: the model 'constant-velocity' has no state 'speed', "
                "expected one of position, velocity")));
}

// Samples of a truth 1 s apart say nothing of the nine instants between them.
TEST(RecordOfLog, TakesASparseTruthWhereItIsToldAlone) {
  const FilterModel model = load_filter_model("constant-velocity");
  Samples times, values;
  for (int k = 0; k < 40; ++k) {
    times.push_back(0.1 * k);
    values.push_back(k);
  }
  const ChannelUse measured = {"position", series("p", "m", times, values)};
  const auto truth_at = [&](double start) {
    return records_of_log(
        model, {measured}, "a.csv",
        {{"position", series("x", "m", {start, start + 1, start + 2}, {5, 7, 11})}});
  };
  const std::vector<double> known = row(truth_at(1)[0].truth, 0);
  EXPECT_NEAR(known[10], 5, 1e-12);
  EXPECT_NEAR(known[20], 7, 1e-12);
  EXPECT_NEAR(known[30], 11, 1e-12);
  EXPECT_EQ(std::count_if(known.begin(), known.end(), [](double x) { return std::isfinite(x); }),
            3);
  // It says nothing about another time.
  EXPECT_THAT(
      [&] { (void)truth_at(100); },
      ThrowsMessage<InvalidInput>(StrEq(
          "a.csv: the truth for 'position' is from 100 s to 102 s and does not cover the log's "
          "instants, 0 s to 3.9 s, expected one of the same flight with the same clock")));
}

/// Inputs and heights of an inertial record, every 0.1 s.
std::vector<ChannelUse> still_inertial(int samples) {
  std::vector<ChannelUse> uses;
  Samples time, zero;
  for (int k = 0; k < samples; ++k) {
    time.push_back(0.1 * k);
    zero.push_back(0);
  }
  for (const char* name : {"gyro_x", "gyro_y", "gyro_z", "force_x", "force_y", "force_z", "height"})
    uses.push_back({name, series(name, "", time, zero)});
  return uses;
}

// Turned by 0.4 rad about z at 0.45 s and 0.8 rad at 0.55 s, the second with the other sign of the
// same quaternion.
TEST(RecordOfLog, TakesAnAttitudeForATruth) {
  const FilterModel model = load_filter_model("inertial");
  const Samples time = {0.45, 0.55};
  const auto component = [&](const char* name, double first, double last) {
    return ChannelUse{name, series(std::string("gt.") + name, "", time, {first, last})};
  };
  const std::vector<ChannelUse> truths = {component("qw", std::cos(0.2), -std::cos(0.4)),
                                          component("qx", 0, 0), component("qy", 0, 0),
                                          component("qz", std::sin(0.2), -std::sin(0.4))};
  const auto records = records_of_log(model, still_inertial(11), "a.csv", truths);
  ASSERT_EQ(records.size(), 1);
  const std::vector<double> turns = row(records[0].truth, 2);
  EXPECT_THAT(turns[4], IsNan());
  EXPECT_NEAR(turns[5], 0.6, 1e-12);
  EXPECT_THAT(turns[6], IsNan());
  EXPECT_NEAR(row(records[0].truth, 0)[5], 0, 1e-12);
  EXPECT_THAT(row(records[0].truth, 3), ::testing::Each(IsNan()));
  // The same in degrees, over the seam at half a turn.
  const std::vector<ChannelUse> angles = {
      {"roll", series("roll", "deg", time, {0, 0})},
      {"pitch", series("pitch", "deg", time, {0, 0})},
      {"yaw", series("yaw", "deg", time, {170, -170})},
  };
  const auto euler = records_of_log(model, still_inertial(11), "a.csv", angles);
  EXPECT_NEAR(std::abs(row(euler[0].truth, 2)[5]), 3.14159265358979, 1e-9);
  // At a sample itself.
  const std::vector<double> late =
      row(records_of_log(model, still_inertial(6), "a.csv",
                         {{"roll", series("roll", "deg", {0, 0.5}, {0, 0})},
                          {"pitch", series("pitch", "deg", {0, 0.5}, {0, 0})},
                          {"yaw", series("yaw", "deg", {0, 0.5}, {20, 170})}})[0]
              .truth,
          2);
  EXPECT_NEAR(late[0], 20 * 3.14159265358979 / 180, 1e-9);
  EXPECT_NEAR(late[5], 170 * 3.14159265358979 / 180, 1e-9);
}

TEST(RecordOfLog, RefusesAnAttitudeThatIsNone) {
  const FilterModel model = load_filter_model("inertial");
  const auto refused = [&](const std::vector<ChannelUse>& truths, const std::string& message) {
    EXPECT_THAT([&] { (void)records_of_log(model, still_inertial(11), "a.csv", truths); },
                ThrowsMessage<InvalidInput>(StrEq("a.csv: " + message)));
  };
  const auto one = [&](const char* name, double value) {
    return ChannelUse{name, series(name, "", {0, 1}, {value, value})};
  };
  refused({one("qw", 1), one("qx", 0), one("qy", 0)},
          "a truth for qz is missing, expected all of qw, qx, qy, qz because an attitude needs all "
          "of them");
  refused({one("qw", 1), one("qx", 1), one("qy", 0), one("qz", 0)},
          "the quaternion of 'qw' has the length 1.414 at 0 s, expected 1");
  refused({one("qw", 1), one("qx", 0), one("qy", 0), one("qz", 0), one("roll", 0), one("pitch", 0),
           one("yaw", 0)},
          "the attitude is given as a quaternion and as roll, pitch, yaw, expected one of them");
  refused({one("yaw", 0), one("yaw", 0)}, "the truth for 'yaw' is given twice, expected once");
}

}  // namespace
}  // namespace quadtune
