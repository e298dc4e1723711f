// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/scheduled_feedback.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "matrix_near.hpp"

namespace quadtune {
namespace {

using testing::MatrixNear;

constexpr double kDt = 0.005;

/// Gains that are linear in speed, climb and yaw rate, so that each condition has gains of its own.
std::shared_ptr<const GainSchedule> linear_schedule() {
  auto schedule = std::make_shared<GainSchedule>(
      empty_schedule({{ScheduleQuantity::speed, {0, 20}},
                      {ScheduleQuantity::climb, {-20, 20}},
                      {ScheduleQuantity::yaw_rate, {-20, 20}}},
                     {{"w", "m/s"}, {"r", "rad/s"}},
                     {{"T", "N"}, {"tau_x", "N m"}, {"tau_y", "N m"}, {"tau_z", "N m"}}, {}));
  schedule->convention = "ned";
  for (Eigen::Index i = 0; i < schedule->size(); ++i) {
    const Eigen::VectorXd at = grid_point(schedule->axes, i);
    schedule->status[static_cast<std::size_t>(i)] = PointStatus::solved;
    schedule->K.col(i) << 30 + at(0), 40 + at(1), 50 + at(2), 60, 70, 80, 90, 100;
    schedule->x0.col(i).setZero();
    schedule->u0.col(i) << 0.3, 0, 0, 0;
    schedule->residual(i) = 1e-16;
  }
  return schedule;
}

Eigen::MatrixXd gain_at(const Estimate<double>& estimate) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  ScheduledFeedback schedule(vehicle, linear_schedule(), kDt);
  StateFeedbackSettings<double> law;
  schedule.set(estimate, {}, law);
  return law.K;
}

Eigen::Matrix3d rotation(double roll, double pitch, double yaw) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

// The attitude does not enter: a tilted vehicle has the gains of a level one that moves over the
// ground, climbs and turns as it does.
TEST(ScheduledFeedback, GainsFollowTheMotionInTheWorld) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    Estimate<double> tilted;
    tilted.x.segment<3>(3) << uniform(random), uniform(random), 3 * uniform(random);
    for (Eigen::Index i = 6; i < 12; ++i) tilted.x(i) = 2 * uniform(random);
    const double yaw = tilted.x(5);
    const Eigen::Matrix3d R = rotation(tilted.x(3), tilted.x(4), yaw);
    Estimate<double> level;
    level.x(5) = yaw;
    level.x.segment<3>(kVelocity) = rotation(0, 0, -yaw) * R * tilted.x.segment<3>(kVelocity);
    // The yaw rate, from the heading a moment before and after.
    constexpr double kMoment = 1e-5;
    const auto heading = [&](double time) {
      const Eigen::Vector3d angle = tilted.x.tail<3>() * time;
      const Eigen::Matrix3d turned =
          R * Eigen::AngleAxisd(angle.norm(), angle.normalized()).toRotationMatrix();
      return std::atan2(turned(1, 0), turned(0, 0));
    };
    level.x(11) =
        std::remainder(heading(kMoment) - heading(-kMoment), 2 * std::numbers::pi) / (2 * kMoment);
    EXPECT_THAT(gain_at(tilted), MatrixNear(gain_at(level), 1e-6)) << tilted.x.transpose();
  }
}

// Speed along the heading, climb upwards, yaw rate clockwise from above: each changes its own
// entry.
TEST(ScheduledFeedback, AxesHaveTheirDirections) {
  Estimate<double> ahead;
  ahead.x(kVelocity) = 5;
  const Eigen::MatrixXd before = gain_at(ahead);
  const auto change = [&](Eigen::Index state, double value, double yaw = 0) {
    Estimate<double> estimate = ahead;
    estimate.x(state) += value;
    estimate.x(5) = yaw;
    return Eigen::MatrixXd(gain_at(estimate) - before);
  };
  const Eigen::MatrixXd speed = change(kVelocity, 1), climb = change(kVelocity + 2, -1),
                        turn = change(kRates + 2, 1);
  for (const Eigen::MatrixXd& change_of_one : {speed, climb, turn})
    EXPECT_EQ((change_of_one.array().abs() > 1e-9).count(), 1);
  EXPECT_NEAR((speed + climb + turn).sum(), 3, 1e-9);
  EXPECT_THAT(change(kVelocity, 1, 2), MatrixNear(speed, 1e-12));
  EXPECT_THAT(change(kVelocity, -2), MatrixNear(-2 * speed, 1e-12));
  EXPECT_THAT(change(kVelocity + 1, 1), MatrixNear(0 * speed, 1e-12));  // sideways
}

}  // namespace
}  // namespace quadtune
