// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/plant.hpp"
#include "vehicle_text.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::plus_quadrotor;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
using testing::vehicle_text;

// 1 - e^(-t/lag) with the lag of the direction, each rotor its own.
TEST(MotorLag, DiffersUpAndDownAndFromRotorToRotor) {
  Vehicle vehicle = plus_quadrotor();
  const double up[] = {0.02, 0.03, 0, 0.04}, down[] = {0.05, 0.01, 0.03, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    vehicle.rotors[i].lag = up[i];
    vehicle.rotors[i].lag_down = down[i];
  }
  for (const double asked : {150.0, 300.0}) {
    Plant<double, 4> plant(RigidBody(vehicle), GroundContact<double>{});
    plant.ground.present = false;
    Plant<double, 4>::State x = Plant<double, 4>::State::Zero();
    x(3) = 1;
    x.tail<4>().setConstant(200);
    plant.command(Eigen::Vector4d::Constant(asked), x);
    for (int i = 0; i < 100; ++i) x = plant.step(Integrator::runge_kutta_4, x, 5e-4);
    for (int i = 0; i < 4; ++i) {
      const double lag = asked > 200 ? up[i] : down[i];
      const double left = lag > 0 ? std::exp(-0.05 / lag) : 0;
      EXPECT_NEAR(x(kRotorSpeeds + i), asked + (200 - asked) * left, 1e-5) << asked << " " << i;
    }
  }
}

TEST(MotorLag, IsReadForBothDirectionsOrEach) {
  const auto rotor = [](const std::string& shared, const std::string& own) {
    return parse_vehicle(vehicle_text(shared, own), "x.toml").rotors[0];
  };
  const Rotor both = rotor("lag_s = 0.03", "");
  EXPECT_EQ(both.lag, 0.03);
  EXPECT_EQ(lag_down(both), 0.03);
  const Rotor each = rotor("lag_up_s = 0.02\nlag_down_s = 0.04", "");
  EXPECT_EQ(each.lag, 0.02);
  EXPECT_EQ(lag_down(each), 0.04);
  EXPECT_EQ(slower_lag(each), 0.04);
  // What one rotor says of one direction leaves the other as it is for all.
  const Rotor own = rotor("lag_s = 0.03", "lag_up_s = 0.01");
  EXPECT_EQ(own.lag, 0.01);
  EXPECT_EQ(lag_down(own), 0.03);
}

TEST(MotorLag, RefusesWhatNoMotorHas) {
  const auto refusal = [](const std::string& shared, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_vehicle(vehicle_text(shared, ""), "x.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal("lag_s = -0.1", "lag_s in [rotor] is -0.1, expected 0 or more and 1 or less");
  refusal("lag_s = 1.5", "lag_s in [rotor] is 1.5, expected 0 or more and 1 or less");
  refusal("lag_down_s = 2", "lag_down_s in [rotor] is 2, expected 0 or more and 1 or less");
  refusal("lag_s = 0.1\nlag_up_s = 0.2",
          "[rotor] has both 'lag_s' and 'lag_up_s', expected lag_s for both directions or lag_up_s "
          "and lag_down_s");
  Vehicle vehicle = plus_quadrotor();
  vehicle.rotors[1].lag_down = 3;
  EXPECT_THAT([&] { validate(vehicle, "here"); },
              ThrowsMessage<InvalidInput>(StrEq("here: rotor 2 lag down is 3 s, expected 0 to 1")));
}

}  // namespace
}  // namespace quadtune
