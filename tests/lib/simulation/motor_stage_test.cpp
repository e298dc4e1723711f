// SPDX-License-Identifier: Apache-2.0
#include "simulation/loop/motor_stage.hpp"

#include <gmock/gmock.h>

#include "plants/sample_vehicles.hpp"

namespace quadtune::internal {
namespace {

using testing::plus_quadrotor;
using Speeds = RotorSpeeds<Pack<1>>;

Speeds speeds_of(std::initializer_list<double> values) {
  Speeds speeds(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) speeds(i++) = value;
  return speeds;
}

double at(const Speeds& speeds, int i) { return lane(speeds(i), 0); }

TEST(MotorStage, HoldsCommandsWithinTheirLimits) {
  const Vehicle vehicle = plus_quadrotor();  // 109 … 387 rad/s
  const MotorStage<1> stage({&vehicle});
  Speeds speeds = speeds_of({50, 200, 387, 500});
  Mask<1> saturated;
  stage.limit(speeds, saturated);
  EXPECT_EQ(at(speeds, 0), 109);
  EXPECT_EQ(at(speeds, 1), 200);
  EXPECT_EQ(at(speeds, 2), 387);
  EXPECT_EQ(at(speeds, 3), 387);
  EXPECT_TRUE(saturated.bits);
  speeds = speeds_of({109, 200, 387, 300});  // at a limit is within it
  stage.limit(speeds, saturated);
  EXPECT_FALSE(saturated.bits);
  speeds = speeds_of({200, 200, 387.001, 300});
  stage.limit(speeds, saturated);
  EXPECT_TRUE(saturated.bits);
}

// The Mambo's command is in counts of squared speed.
TEST(MotorStage, LimitsSquaredSpeedsInCounts) {
  const Vehicle mambo = load_vehicle("mambo");
  const MotorStage<1> stage({&mambo});
  const auto speed = [](double counts) { return std::sqrt(13840.8 * counts); };
  Speeds speeds = speeds_of({speed(5), speed(123.4), speed(499.9), speed(600)});
  Mask<1> saturated;
  stage.limit(speeds, saturated);
  EXPECT_NEAR(at(speeds, 0), speed(10), 1e-10);
  EXPECT_NEAR(at(speeds, 1), speed(123.4), 1e-10);
  EXPECT_NEAR(at(speeds, 2), speed(499.9), 1e-10);
  EXPECT_NEAR(at(speeds, 3), speed(500), 1e-10);
  EXPECT_TRUE(saturated.bits);
}

TEST(MotorStage, RoundsCommandsToTheirQuantum) {
  Vehicle mambo = load_vehicle("mambo");
  mambo.motor.quantum = 1;
  Vehicle plus = plus_quadrotor();
  plus.motor.quantum = 2;
  const auto speed = [](double counts) { return std::sqrt(13840.8 * counts); };
  Mask<1> saturated;
  Speeds speeds = speeds_of({speed(123.4), speed(123.6)});
  MotorStage<1>({&mambo}).limit(speeds, saturated);
  EXPECT_NEAR(at(speeds, 0), speed(123), 1e-10);
  EXPECT_NEAR(at(speeds, 1), speed(124), 1e-10);
  speeds = speeds_of({200.9, 201.1});
  MotorStage<1>({&plus}).limit(speeds, saturated);
  EXPECT_EQ(at(speeds, 0), 200);
  EXPECT_EQ(at(speeds, 1), 202);
  EXPECT_FALSE(saturated.bits);
}

// Up to the least command and never beyond it, with jumps of a tenth to either side.
TEST(MotorStage, StartsUpOnARampWithJumps) {
  const Vehicle vehicle = plus_quadrotor();
  const MotorStage<1> stage({&vehicle});
  Speeds speeds = speeds_of({0, 0, 0, 0});
  for (const double share : {0.0, 0.3, 0.5, 0.8}) {
    stage.start_up(share, 6, speeds);
    EXPECT_NEAR(at(speeds, 0), 109 * share * 0.9, 1e-12);
    stage.start_up(share, 7, speeds);
    EXPECT_NEAR(at(speeds, 3), 109 * share * 1.1, 1e-12);
  }
  stage.start_up(1, 7, speeds);
  EXPECT_EQ(at(speeds, 1), 109);
}

TEST(MotorStage, SharesGoOverTheRangeOfCommands) {
  const Vehicle mambo = load_vehicle("mambo");
  const MotorStage<1> stage({&mambo});
  Speeds speeds = speeds_of({1, 1, 1, 1});
  Eigen::Matrix<double, kMaxRotors, 1> shares = Eigen::Matrix<double, kMaxRotors, 1>::Constant(-1);
  shares.head<3>() << 0, 0.5, 1;
  stage.shares(shares, speeds);
  EXPECT_NEAR(at(speeds, 0), std::sqrt(13840.8 * 10), 1e-10);
  EXPECT_NEAR(at(speeds, 1), std::sqrt(13840.8 * 255), 1e-10);
  EXPECT_NEAR(at(speeds, 2), std::sqrt(13840.8 * 500), 1e-10);
  EXPECT_EQ(at(speeds, 3), 0);
}

TEST(MotorStage, CommandsBecomeSpeeds) {
  const Vehicle mambo = load_vehicle("mambo");
  const MotorStage<1> stage({&mambo});
  Speeds speeds = speeds_of({0, 0});
  Eigen::Matrix<Pack<1>, kMaxRotors, 1> commands;
  commands.setConstant(Pack<1>(0));
  commands(0) = 200;
  commands(1) = -3;
  stage.speeds_of_commands(commands, speeds);
  EXPECT_NEAR(at(speeds, 0), speed_of_command(mambo.motor, 200), 1e-10);
  EXPECT_EQ(at(speeds, 1), 0);
}

// Regulated motors turn as commanded up to what the voltage allows; others follow it in proportion.
TEST(MotorStage, ABatteryTakesItsShare) {
  const Vehicle vehicle = plus_quadrotor();
  const MotorStage<1> stage({&vehicle});
  Battery battery;
  battery.rated_voltage = 12;
  BatteryState<Pack<1>> state;
  state.voltage = 9;
  Speeds speeds = speeds_of({200, 280, 300, 387});
  Mask<1> saturated = false;
  stage.supply(battery, state, speeds, saturated);
  EXPECT_EQ(at(speeds, 0), 200);
  EXPECT_EQ(at(speeds, 1), 280);
  EXPECT_DOUBLE_EQ(at(speeds, 2), 0.75 * 387);
  EXPECT_DOUBLE_EQ(at(speeds, 3), 0.75 * 387);
  EXPECT_TRUE(saturated.bits);
  battery.regulated = false;
  speeds = speeds_of({200, 280, 300, 387});
  saturated = false;
  stage.supply(battery, state, speeds, saturated);
  for (int i = 0; i < 4; ++i)
    EXPECT_DOUBLE_EQ(at(speeds, i), 0.75 * at(speeds_of({200, 280, 300, 387}), i));
  EXPECT_FALSE(saturated.bits);
}

TEST(MotorStage, EachLaneHasItsOwnVehicle) {
  Vehicle a = plus_quadrotor(), b = a;
  b.motor.max = 300;
  b.motor.quantum = 10;
  const MotorStage<2> stage({&a, &b});
  RotorSpeeds<Pack<2>> speeds(1);
  speeds(0) = 303;
  Mask<2> saturated;
  stage.limit(speeds, saturated);
  EXPECT_EQ(lane(speeds(0), 0), 303);
  EXPECT_EQ(lane(speeds(0), 1), 300);
  EXPECT_FALSE(lane(saturated, 0));
  EXPECT_FALSE(lane(saturated, 1));  // what is rounded to the limit is within it
}

}  // namespace
}  // namespace quadtune::internal
