// SPDX-License-Identifier: Apache-2.0
/// PID rules from the limit of stability.
#include "quadtune/synthesis/pid/ultimate_rules.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

// K/(s + 1)³ oscillates at w = √3 with K = 8.
TEST(UltimatePoint, OfThreeEqualLags) {
  const UltimatePoint point =
      ultimate_point({Eigen::VectorXd::Ones(1), Eigen::Vector4d(1, 3, 3, 1), 0});
  ASSERT_TRUE(point.exists()) << point.culprit;
  EXPECT_NEAR(point.gain, 8, 1e-8);
  EXPECT_NEAR(point.period, 2 * std::numbers::pi / std::sqrt(3.0), 1e-8);
}

TEST(UltimatePoint, OfAnIntegratorWithDelay) {
  const UltimatePoint point =
      ultimate_point({Eigen::VectorXd::Ones(1), Eigen::Vector2d(1, 0), 0.1});
  ASSERT_TRUE(point.exists()) << point.culprit;
  EXPECT_NEAR(point.gain, std::numbers::pi / 0.2, 1e-6);
  EXPECT_NEAR(point.period, 0.4, 1e-8);
}

TEST(UltimatePoint, OfAFirstOrderLagDoesNotExist) {
  const UltimatePoint point = ultimate_point({Eigen::VectorXd::Ones(1), Eigen::Vector2d(1, 1), 0});
  EXPECT_FALSE(point.exists());
  EXPECT_NE(point.culprit, "");
}

TEST(UltimateRule, ZieglerNicholsIsTheSameAsWithoutAName) {
  for (const PidType type : {PidType::P, PidType::PI, PidType::PID}) {
    const PidGains named = ultimate_rule("ziegler-nichols", type, 3, 0.7);
    const PidGains gains = ziegler_nichols_ultimate(type, 3, 0.7);
    EXPECT_NEAR(named.Kp, gains.Kp, 1e-14);
    EXPECT_NEAR(named.Ki, gains.Ki, 1e-14);
    EXPECT_NEAR(named.Kd, gains.Kd, 1e-14);
    EXPECT_NEAR(named.Tf, gains.Tf, 1e-14);
  }
}

TEST(UltimateRule, PublishedNumbers) {
  const PidGains tyreus = ultimate_rule("tyreus-luyben", PidType::PI, 3.2, 2);
  EXPECT_NEAR(tyreus.Kp, 1, 1e-12);
  EXPECT_NEAR(tyreus.Ki, 1 / 4.4, 1e-12);
  const PidGains pessen = ultimate_rule("pessen", PidType::PID, 10, 2);
  EXPECT_NEAR(pessen.Kp, 7, 1e-12);
  EXPECT_NEAR(pessen.Ki, 7 / 0.8, 1e-12);
  EXPECT_NEAR(pessen.Kd, 7 * 0.3, 1e-12);
  EXPECT_NEAR(pessen.Tf, 0.03, 1e-12);
}

TEST(UltimateRule, InvalidInputIsRejected) {
  EXPECT_THROW((void)ultimate_rule("pesen", PidType::PID, 1, 1), InvalidInput);
  EXPECT_THROW((void)ultimate_rule("pessen", PidType::PI, 1, 1), InvalidInput);
  EXPECT_THROW((void)ultimate_rule("pessen", PidType::PID, 0, 1), InvalidInput);
  EXPECT_THROW((void)ultimate_rule("pessen", PidType::PID, 1, 0), InvalidInput);
  EXPECT_THROW((void)ultimate_rule("pessen", PidType::PID, 1, 1, 0), InvalidInput);
}

}  // namespace
}  // namespace quadtune
