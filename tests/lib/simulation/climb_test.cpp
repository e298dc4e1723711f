// SPDX-License-Identifier: Apache-2.0
#include "simulation/mission/climb.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/simulation/mission_runner.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A trapezoid of speed over time has the area of its height; a climb too short for it is a
// triangle.
TEST(Climb, LastsAsLongAsItsTrapezoid) {
  EXPECT_DOUBLE_EQ(climb_duration(5, 2), 5.0 / 2 + 2);
  EXPECT_DOUBLE_EQ(climb_duration(0.25, 2), 2 * std::sqrt(0.25));
  EXPECT_EQ(climb_duration(0, 1), 0);
}

TEST(Climb, MovesWithinItsSpeedAndAcceleration) {
  for (const double height : {0.04, 1.1, 7.0})
    for (const double rate : {0.3, 1.0, 3.0}) {
      const double duration = climb_duration(height, rate), dt = duration / 1000;
      ClimbPoint before;
      for (int k = 1; k <= 1010; ++k) {
        const ClimbPoint now = climb_at(height, rate, k * dt);
        EXPECT_LE(now.speed, rate * (1 + 1e-12));
        EXPECT_LE(std::abs(now.speed - before.speed), kClimbAcceleration * dt * (1 + 1e-9));
        // The speed is the slope of the height.
        EXPECT_NEAR(now.height - before.height, 0.5 * (now.speed + before.speed) * dt,
                    kClimbAcceleration * dt * dt);
        before = now;
      }
      EXPECT_EQ(before.height, height);
      EXPECT_EQ(before.speed, 0);
    }
  EXPECT_EQ(climb_at(1, 1, -1).height, 0);
}

Mission mission(const std::string& start) {
  return parse_mission("name = \"m\"\nduration_s = 20\n[start]\nat = \"ground\"\n" + start +
                           "\n[hover]\nheight_m = 1.1\n",
                       "m.toml");
}

TEST(Climb, TakesAVehicleOffUnderItsLaw) {
  const Mission flown = mission("start_up_s = 0.5\nclimb_rate_m_per_s = 0.5");
  const double end = 0.5 + climb_duration(1.1, 0.5);
  EXPECT_DOUBLE_EQ(end_of_take_off(flown), end);
  MissionRunner runner(flown);
  const StateVector<double> anywhere = StateVector<double>::Zero();
  EXPECT_EQ(runner.at(0, anywhere).phase, FlightPhase::start_up);
  Reference<double> reference = runner.at(0.5, anywhere);
  EXPECT_EQ(reference.phase, FlightPhase::flying);
  EXPECT_EQ(runner.event(), MissionEvent::take_off);
  EXPECT_EQ(reference.position.z(), 0);
  reference = runner.at(1.5, anywhere);
  EXPECT_NEAR(reference.position.z(), -climb_at(1.1, 0.5, 1).height, 1e-15);
  EXPECT_NEAR(reference.velocity.z(), -0.5, 1e-15);
  reference = runner.at(end + 1e-9, anywhere);
  EXPECT_EQ(runner.event(), MissionEvent::flying);
  EXPECT_EQ(reference.position.z(), -1.1);
  EXPECT_EQ(reference.velocity.z(), 0);
}

TEST(Climb, IsNotTheTakeOffOfTheModelProject) {
  const Mission source = with_thrust_take_off(mission("start_up_s = 0.5"));
  MissionRunner runner(source);
  EXPECT_EQ(runner.at(0.6, StateVector<double>::Zero()).phase, FlightPhase::take_off);
  EXPECT_DOUBLE_EQ(end_of_take_off(source), 1.5);
  EXPECT_EQ(mission("take_off_s = 1").start, source.start);
}

TEST(Climb, RefusesTwoWaysAtOnce) {
  EXPECT_THAT(
      [] { (void)mission("take_off_s = 1\nclimb_rate_m_per_s = 1"); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "m.toml:6: climb_rate_m_per_s and take_off_s are both given, expected one of them")));
  EXPECT_THAT([] { (void)mission("climb_rate_m_per_s = 0"); },
              ThrowsMessage<InvalidInput>(HasSubstr("climb_rate_m_per_s")));
  EXPECT_THAT([] { (void)mission("climb_rate_m_per_s = 0.05"); },
              ThrowsMessage<InvalidInput>(HasSubstr(" m last 22.55 s, expected "
                                                    "less than the mission's duration_s of 20")));
}

}  // namespace
}  // namespace quadtune
