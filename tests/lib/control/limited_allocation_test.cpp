// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/limited_allocation.hpp"

#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/simulation/pack.hpp"

namespace quadtune {
namespace {

using Eigen::Vector4d;
using ::testing::HasSubstr;
using testing::kInfinity;
using testing::kNaN;
using testing::MatrixNear;
using testing::random_vehicle;
using ::testing::ThrowsMessage;

struct Case {
  Vehicle vehicle;
  Allocation<double> law;
  ThrustLimits<double> limits;
  double weight = 0;

  explicit Case(const Vehicle& of)
      : vehicle(of), law(allocation(of)), limits(thrust_limits(of)), weight(of.mass * of.gravity) {}

  // How far a rotor is outside its limits for this wrench [N].
  [[nodiscard]] double beyond(const Vector4d& wrench) const {
    const RotorSpeeds<double> thrusts = thrusts_of_wrench<double>(law, wrench);
    double max = 0;
    for (int i = 0; i < law.rotors; ++i) {
      const auto k = static_cast<std::size_t>(i);
      max = std::max({max, limits.min[k] - thrusts(i), thrusts(i) - limits.max[k]});
    }
    return max;
  }
};

std::vector<Case> cases() {
  std::mt19937_64 random(11);
  std::vector<Case> all;
  for (const char* name : {"mambo", "uquad", "crazyflie"}) all.emplace_back(load_vehicle(name));
  for (const int rotors : {4, 6, 8})
    for (int trial = 0; trial < 3; ++trial) {
      Vehicle vehicle = random_vehicle(random, rotors);
      // Twice the weight at maximum speed, zero at minimum speed.
      vehicle.motor.min = 0;
      vehicle.motor.max =
          vehicle.motor.max * std::sqrt(2 * vehicle.mass * vehicle.gravity / max_thrust(vehicle));
      try {
        all.emplace_back(vehicle);
      } catch (const InvalidInput&) {
        continue;  // a random layout that cannot hover
      }
    }
  return all;
}

Vector4d draw_case(std::mt19937_64& random, const Case& of, double size) {
  std::uniform_real_distribution<double> between(-1, 1);
  const double torque = of.weight * of.vehicle.rotors[0].position.norm();
  return {of.weight * (1 + size * between(random)), size * torque * between(random),
          size * torque * between(random), 0.1 * size * torque * between(random)};
}

TEST(LimitedAllocation, LeavesAWrenchThatTheRotorsCanProduce) {
  std::mt19937_64 random(1);
  for (const Case& of : cases())
    for (int trial = 0; trial < 200; ++trial) {
      const Vector4d asked = draw_case(random, of, 0.3);
      if (of.beyond(asked) > 0 || asked(0) < of.limits.floor) continue;
      for (const LimitedWrench<double>& made : {prioritized<double>(of.law, of.limits, asked),
                                                clipped<double>(of.law, of.limits, asked)}) {
        EXPECT_FALSE(made.limited);
        EXPECT_EQ(made.wrench, asked);
      }
    }
}

// The greatest share of the roll and pitch torque for which a collective thrust exists, by
// bisection.
double greatest_share(const Case& of, const Vector4d& asked) {
  const auto feasible = [&](double share) {
    double low = -kInfinity, high = -low;
    for (int i = 0; i < of.law.rotors; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double at_zero =
          thrusts_of_wrench<double>(of.law, Vector4d(0, share * asked(1), share * asked(2), 0))(i);
      low = std::max(low, (of.limits.min[k] - at_zero) / of.law.P(i, 0));
      high = std::min(high, (of.limits.max[k] - at_zero) / of.law.P(i, 0));
    }
    return low <= high;
  };
  if (feasible(1)) return 1;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) (feasible(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  return low;
}

// Of any wrench: all rotors within their limits, as much of the roll and pitch torque as any thrust
// allows and in their proportion, and no more of anything than was asked.
TEST(LimitedAllocation, GivesUpYawThenThrustThenRollAndPitch) {
  std::mt19937_64 random(2);
  for (const Case& of : cases()) {
    if ((of.law.P.col(0).head(of.law.rotors).array() <= 0).any()) continue;
    for (int trial = 0; trial < 200; ++trial) {
      const Vector4d asked = draw_case(random, of, trial < 100 ? 1.5 : 20);
      const LimitedWrench<double> result = prioritized<double>(of.law, of.limits, asked);
      const Vector4d& made = result.wrench;
      ASSERT_TRUE(made.allFinite());
      EXPECT_LT(of.beyond(made), 1e-8 * of.weight) << of.vehicle.name;
      const double share = greatest_share(of, asked);
      EXPECT_NEAR(made(1), share * asked(1), 1e-8 * std::abs(asked(1)) + 1e-15);
      EXPECT_NEAR(made(2), share * asked(2), 1e-8 * std::abs(asked(2)) + 1e-15);
      EXPECT_GE(made(3) * asked(3), 0);
      EXPECT_LE(std::abs(made(3)), std::abs(asked(3)));
      // The thrust is that asked for, or one step nearer to it would break a limit or the floor.
      const double step = 1e-6 * of.weight * (asked(0) > made(0) ? 1 : -1);
      if (std::abs(asked(0) - made(0)) > std::abs(step)) {
        const Vector4d nearer(made(0) + step, made(1), made(2), 0);
        EXPECT_TRUE(of.beyond(nearer) > 0 || nearer(0) < of.limits.floor) << of.vehicle.name;
      }
      // Yaw torque is reduced only if a rotor is at its limit.
      if (std::abs(made(3)) < std::abs(asked(3)) * (1 - 1e-6)) {
        const Vector4d more(made(0), made(1), made(2), made(3) + 1e-4 * asked(3));
        EXPECT_GT(of.beyond(more), -1e-12 * of.weight);
      }
    }
  }
}

// A law above its height asks for no thrust: cut rotor by rotor, the torque that holds the vehicle
// upright is lost with it; by priorities it is all there.
TEST(LimitedAllocation, KeepsTheTorqueOfALawThatAsksForNoThrust) {
  const Case of(load_vehicle("mambo"));
  const double torque = 2e-3;
  const Vector4d asked(0, torque, 0, 0);
  const Vector4d made = prioritized<double>(of.law, of.limits, asked).wrench;
  EXPECT_NEAR(made(1), torque, 1e-12);
  EXPECT_NEAR(made(2), 0, 1e-12);
  // Two rotors at their minimum, two above it as the torque requires: 4 t_min + τ/arm.
  const double arm = of.vehicle.rotors[1].position.y();
  EXPECT_NEAR(made(0), std::max(of.limits.floor, 4 * of.limits.min[0] + torque / arm), 1e-9);
  const Vector4d cut = clipped<double>(of.law, of.limits, asked).wrench;
  EXPECT_LT(cut(1), 0.6 * torque);
  // And a thrust of 0 alone is raised to the floor.
  EXPECT_NEAR(prioritized<double>(of.law, of.limits, Vector4d(0, 0, 0, 0)).wrench(0),
              kMinCollective * of.weight, 1e-12);
}

TEST(LimitedAllocation, ReturnsFiniteNumbersForEntriesThatAreNotFinite) {
  const Case of(load_vehicle("mambo"));
  for (const double bad : {kNaN, kInfinity, -kInfinity})
    for (int i = 0; i < 4; ++i) {
      Vector4d asked(of.weight, 1e-4, -1e-4, 1e-5);
      asked(i) = bad;
      const LimitedWrench<double> made = prioritized<double>(of.law, of.limits, asked);
      EXPECT_TRUE(made.limited);
      EXPECT_TRUE(made.wrench.allFinite());
      EXPECT_LT(of.beyond(made.wrench), 1e-9);
    }
}

TEST(LimitedAllocation, IsTheSameInEveryLane) {
  std::mt19937_64 random(5);
  const Case of(load_vehicle("mambo"));
  using P = Pack<kPackLanes>;
  Allocation<P> law;
  ThrustLimits<P> limits;
  law.rotors = of.law.rotors;
  law.P = of.law.P.cast<P>();
  law.M = of.law.M.cast<P>();
  law.wrench0 = of.law.wrench0.cast<P>();
  law.thrust0 = of.law.thrust0.cast<P>();
  for (std::size_t k = 0; k < 4; ++k) {
    limits.min[k] = of.limits.min[k];
    limits.max[k] = of.limits.max[k];
  }
  limits.floor = of.limits.floor;
  std::array<Vector4d, kPackLanes> asked;
  Eigen::Matrix<P, 4, 1> all;
  for (int l = 0; l < kPackLanes; ++l) {
    asked[static_cast<std::size_t>(l)] = draw_case(random, of, l % 2 == 0 ? 0.05 : 3);
    for (int i = 0; i < 4; ++i) set_lane(all(i), l, asked[static_cast<std::size_t>(l)](i));
  }
  const LimitedWrench<P> together = prioritized<P>(law, limits, all);
  for (int l = 0; l < kPackLanes; ++l) {
    const LimitedWrench<double> alone =
        prioritized<double>(of.law, of.limits, asked[static_cast<std::size_t>(l)]);
    EXPECT_EQ(lane(together.limited, l), alone.limited);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(lane(together.wrench(i), l), alone.wrench(i));
  }
}

TEST(LimitedAllocation, KnowsItsRulesByName) {
  for (const AllocationRule rule : {AllocationRule::prioritized, AllocationRule::clipped})
    EXPECT_EQ(allocation_rule(to_string(rule), "test"), rule);
  EXPECT_THAT([] { (void)allocation_rule("prioritised", "--allocation"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("no allocation 'prioritised', expected prioritized or clipped; did you "
                            "mean 'prioritized'?")));
}

}  // namespace
}  // namespace quadtune
