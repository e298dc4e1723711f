// SPDX-License-Identifier: Apache-2.0
#include "quadtune/gain_schedule.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/flight_condition.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

const double kNan = std::nan("");

/// Two inputs, one state, one integral over 3 speeds and 2 yaw rates; K(0) = v + 10 r + 100 v r,
/// which multilinear interpolation meets everywhere.
double law(double v, double r) { return v + 10 * r + 100 * v * r; }

GainSchedule bilinear() {
  GainSchedule schedule =
      empty_schedule({{ScheduleQuantity::speed, {0, 1, 4}}, {ScheduleQuantity::yaw_rate, {-1, 1}}},
                     {{"x", "m"}}, {{"a", "N"}, {"b", "N"}}, {{"x", "m s"}});
  schedule.convention = "ned";
  for (Eigen::Index i = 0; i < schedule.size(); ++i) {
    const Eigen::VectorXd at = grid_point(schedule.axes, i);
    const double value = law(at(0), at(1));
    schedule.status[static_cast<std::size_t>(i)] = PointStatus::solved;
    schedule.K.col(i) << value, -value;
    schedule.K_int.col(i) << 2 * value, 3 * value;
    schedule.x0(0, i) = at(0);
    schedule.u0.col(i) << at(1), 7;
    schedule.residual(i) = 1e-16;
  }
  return schedule;
}

TEST(GainSchedule, LastAxisRunsFastest) {
  const GainSchedule schedule = bilinear();
  ASSERT_EQ(schedule.size(), 6);
  EXPECT_EQ(grid_point(schedule.axes, 0), Eigen::Vector2d(0, -1));
  EXPECT_EQ(grid_point(schedule.axes, 1), Eigen::Vector2d(0, 1));
  EXPECT_EQ(grid_point(schedule.axes, 4), Eigen::Vector2d(4, -1));
}

TEST(GainSchedule, IsExactAtItsPoints) {
  const GainSchedule schedule = bilinear();
  for (Eigen::Index i = 0; i < schedule.size(); ++i) {
    const ScheduledGain gain = schedule.at(grid_point(schedule.axes, i));
    ASSERT_TRUE(gain.found()) << gain.culprit;
    const Gains point = schedule.gains(i);
    EXPECT_EQ(gain.K, point.K);
    EXPECT_EQ(gain.K_int, point.K_int);
    EXPECT_EQ(gain.x0, point.x0);
    EXPECT_EQ(gain.u0, point.u0);
  }
}

TEST(GainSchedule, IsMultilinearBetween) {
  const GainSchedule schedule = bilinear();
  for (const double v : {0.0, 0.3, 1.0, 1.7, 3.9})
    for (const double r : {-1.0, -0.2, 0.0, 0.9}) {
      const ScheduledGain gain = schedule.at(Eigen::Vector2d(v, r));
      ASSERT_TRUE(gain.found()) << gain.culprit;
      EXPECT_THAT(gain.K,
                  MatrixNear(Eigen::MatrixXd(Eigen::Vector2d(law(v, r), -law(v, r))), 1e-12));
      EXPECT_THAT(
          gain.K_int,
          MatrixNear(Eigen::MatrixXd(Eigen::Vector2d(2 * law(v, r), 3 * law(v, r))), 1e-12));
      EXPECT_NEAR(gain.x0(0), v, 1e-14);
      EXPECT_NEAR(gain.u0(0), r, 1e-14);
      EXPECT_NEAR(gain.u0(1), 7, 1e-14);
    }
}

TEST(GainSchedule, DoesNotExtrapolate) {
  const GainSchedule schedule = bilinear();
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(-0.1, 0), Eigen::Vector2d(4.1, 0),
                                    Eigen::Vector2d(1, 1.01), Eigen::Vector2d(kNan, 0)}) {
    const ScheduledGain gain = schedule.at(at);
    EXPECT_EQ(gain.status, LookupStatus::outside) << at.transpose();
    EXPECT_THAT(gain.culprit, HasSubstr("outside the grid's range from"));
    EXPECT_EQ(gain.K.size(), 0);
  }
  EXPECT_TRUE(schedule.at(Eigen::Vector2d(4 * (1 + 1e-12), 1)).found()) << "rounding";
}

TEST(GainSchedule, RejectsCellsWithAnUnsolvedPoint) {
  GainSchedule schedule = bilinear();
  schedule.status[2] = PointStatus::no_trim;  // speed 1, yaw rate -1
  schedule.culprit[2] = "too heavy";
  schedule.K.col(2).setConstant(kNan);
  const ScheduledGain gain = schedule.at(Eigen::Vector2d(0.5, 0));
  EXPECT_EQ(gain.status, LookupStatus::infeasible);
  EXPECT_EQ(gain.culprit, "no trim at speed 1, yaw_rate -1: too heavy");
  EXPECT_EQ(gain.K.size(), 0);
  // Its neighbours themselves, and the edges between them, do not need it.
  EXPECT_TRUE(schedule.at(Eigen::Vector2d(0, -1)).found());
  EXPECT_TRUE(schedule.at(Eigen::Vector2d(0.5, 1)).found());
  EXPECT_TRUE(schedule.at(Eigen::Vector2d(0, 0.3)).found());
}

TEST(GainSchedule, AnAxisOfOneValueHoldsThere) {
  GainSchedule schedule =
      empty_schedule({{ScheduleQuantity::mass, {1.1}}}, {{"x", "m"}}, {{"a", "N"}}, {});
  schedule.status[0] = PointStatus::solved;
  schedule.K(0, 0) = 5;
  schedule.x0(0, 0) = schedule.u0(0, 0) = 0;
  EXPECT_EQ(schedule.at(Eigen::VectorXd::Constant(1, 1.1)).K(0, 0), 5);
  EXPECT_FALSE(schedule.at(Eigen::VectorXd::Constant(1, 1.2)).found());
}

TEST(GainSchedule, RefusesAnotherNumberOfValues) {
  EXPECT_THAT([] { (void)bilinear().at(Eigen::VectorXd::Zero(1)); },
              ThrowsMessage<InvalidInput>(HasSubstr("got 1 value, expected 2")));
}

TEST(GainSchedule, RejectsInvalidGrids) {
  const auto refuses = [](const std::vector<ScheduleAxis>& axes, const std::string& why) {
    EXPECT_THAT([&] { (void)checked_grid_size(axes, "here"); },
                ThrowsMessage<InvalidInput>(HasSubstr(why)));
  };
  const auto speed = ScheduleQuantity::speed;
  refuses({}, "no axis");
  refuses({{speed, {}}}, "speed has no values");
  refuses({{speed, {0, kNan}}}, "speed has nan");
  refuses({{speed, {1, 1}}}, "speed has 1 after 1, expected ascending");
  refuses({{speed, {2, 1}}}, "speed has 1 after 2");
  refuses({{speed, {-1}}}, "speed has -1 m/s");
  refuses({{ScheduleQuantity::mass, {0}}}, "mass has 0, expected more than 0");
  refuses({{ScheduleQuantity::density, {-0.5, 1}}}, "density has -0.5");
  refuses({{speed, {1}}, {speed, {2}}}, "speed is given twice");
  std::vector<double> many;
  many.reserve(400);
  for (int i = 0; i < 400; ++i) many.push_back(i);
  refuses({{speed, many}, {ScheduleQuantity::climb, many}}, "has more than 100000 points");
}

TEST(GainSchedule, NamesItsQuantities) {
  for (const char* name : {"speed", "climb", "yaw_rate", "mass", "density"})
    EXPECT_EQ(to_string(schedule_quantity(name, "here")), name);
  EXPECT_THAT([] { (void)schedule_quantity("yaw-rate", "here"); },
              ThrowsMessage<InvalidInput>(HasSubstr("did you mean 'yaw_rate'?")));
}

TEST(FlightCondition, KindFollowsFromSpeedAndYawRate) {
  EXPECT_EQ(steady_flight(0, 0, 0).kind, FlightKind::hover);
  EXPECT_EQ(steady_flight(0, 1, 0).kind, FlightKind::line);
  EXPECT_EQ(steady_flight(2, 0, 0).kind, FlightKind::line);
  EXPECT_EQ(steady_flight(0, 0, 0.5).kind, FlightKind::spin);
  EXPECT_EQ(steady_flight(0, 0, 0.5).yaw_rate, 0.5);
  const FlightCondition left = steady_flight(2, 0.3, -0.5, 1);
  EXPECT_EQ(left.kind, FlightKind::circle);
  EXPECT_EQ(left.radius, -4);
  EXPECT_EQ(left.climb, 0.3);
  EXPECT_EQ(left.yaw, 1);
}

}  // namespace
}  // namespace quadtune
