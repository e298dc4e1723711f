// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_optimum.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "pid/loop_shape.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Eigen::VectorXd kUnit = Eigen::VectorXd::Ones(1);

ContinuousTransferFunction three_equal_lags() { return {kUnit, Eigen::Vector4d(1, 3, 3, 1), 0}; }

/// Maximum Ki of a PI by brute force: Kp and Ki on a fine grid, Ms on another, stability by Routh.
double looked_for_PI(double Ms_max) {
  double best = 0;
  for (int i = 0; i < 170; ++i) {
    const double Kp = 0.3 * std::pow(1.01, i);
    const double start = std::max(best, 0.2);
    for (int j = 0; j < 900; ++j) {
      const double Ki = start * std::pow(1.002, j);
      // s⁴ + 3 s³ + 3 s² + (1 + Kp) s + Ki: stable for (1 + Kp)(9 - 1 - Kp) > 9 Ki
      if (!((1 + Kp) * (8 - Kp) > 9 * Ki)) break;
      double min = 1;
      for (int k = 0; k < 300; ++k) {
        const std::complex<double> s(0, 0.2 * std::pow(1.01, k));
        min = std::min(min, std::abs(1.0 + (Kp + Ki / s) / std::pow(s + 1.0, 3)));
      }
      if (1 / min > Ms_max) break;
      best = std::max(best, Ki);
    }
  }
  return best;
}

// Åström, Panagopoulos, Hägglund 1998 print K = 0.633, Ti = 1.945 for Ms = 1.4 and K = 1.22,
// Ti = 1.78 for Ms = 2.
TEST(GreatestIntegralGain, OfPiForThreeLags) {
  const PidOptimum careful = max_integral_gain(three_equal_lags(), PidType::PI, {.Ms_max = 1.4});
  ASSERT_TRUE(careful.solved()) << careful;
  EXPECT_NEAR(careful.gains.Kp, 0.633, 2e-3) << careful;
  EXPECT_NEAR(careful.gains.Kp / careful.gains.Ki, 1.945, 5e-3);
  EXPECT_THAT(careful.binding, ElementsAre("Ms"));
  const PidOptimum bold = max_integral_gain(three_equal_lags(), PidType::PI, {.Ms_max = 2});
  ASSERT_TRUE(bold.solved()) << bold;
  EXPECT_NEAR(bold.gains.Kp, 1.22, 5e-3) << bold;
  EXPECT_NEAR(bold.gains.Kp / bold.gains.Ki, 1.78, 5e-3);
  EXPECT_NEAR(careful.gains.Ki, looked_for_PI(1.4), 2e-3 * careful.gains.Ki);
}

TEST(GreatestIntegralGain, NamesTheBoundThatBinds) {
  const double kNone = std::numeric_limits<double>::infinity();
  const PidOptimum Mt =
      max_integral_gain(three_equal_lags(), PidType::PI, {.Ms_max = 3, .Mt_max = 1.1});
  ASSERT_TRUE(Mt.solved()) << Mt;
  EXPECT_THAT(Mt.binding, ElementsAre("Mt"));
  EXPECT_LE(Mt.Mt, 1.1);
  const PidOptimum noise = max_integral_gain(
      three_equal_lags(), PidType::PID, {.Ms_max = 2, .Mt_max = kNone, .noise_gain_max = 3}, 0.1);
  ASSERT_TRUE(noise.solved()) << noise;
  EXPECT_THAT(noise.binding, ::testing::Contains("noise gain"));
  EXPECT_LE(noise.noise_gain, 3 * (1 + 1e-6));
  EXPECT_LE(noise.Ms, 2 * (1 + 1e-6));
}

// A derivative helps, and its bounds hold in the loop of a plant with delay; near the
// optimum, every point with a larger Ki violates a bound.
TEST(GreatestIntegralGain, CannotBeImprovedNearby) {
  const ContinuousTransferFunction P = {kUnit, Eigen::Vector2d(0.5, 1), 0.3};
  const PidBounds bounds = {.Ms_max = 1.6, .Mt_max = 1.4, .noise_gain_max = 12};
  const PidOptimum without_D = max_integral_gain(P, PidType::PI, bounds);
  const PidOptimum pid = max_integral_gain(P, PidType::PID, bounds, 0.02);
  ASSERT_TRUE(without_D.solved()) << without_D;
  ASSERT_TRUE(pid.solved()) << pid;
  EXPECT_GT(pid.gains.Ki, without_D.gains.Ki);
  const internal::LoopShape shape(P, {});
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      const PidGains more = {pid.gains.Kp * (1 + 0.01 * i), pid.gains.Ki * 1.002,
                             pid.gains.Kd * (1 + 0.01 * j), pid.gains.Tf};
      const internal::SensitivityPeaks peaks = shape.peaks(more);
      EXPECT_FALSE(peaks.Ms <= bounds.Ms_max && peaks.Mt <= bounds.Mt_max &&
                   shape.noise_gain(more) <= bounds.noise_gain_max && shape.stable(more))
          << more << " beats " << pid;
    }
  }
}

TEST(GreatestIntegralGain, FollowsTheSignOfThePlant) {
  ContinuousTransferFunction P = three_equal_lags();
  const PidOptimum one = max_integral_gain(P, PidType::PI, {});
  P.num *= -2;
  const PidOptimum other = max_integral_gain(P, PidType::PI, {});
  ASSERT_TRUE(one.solved() && other.solved());
  EXPECT_NEAR(other.gains.Ki, -one.gains.Ki / 2, 1e-4 * one.gains.Ki);
}

TEST(GreatestIntegralGain, ReportsInfeasibleBounds) {
  // 1/(s - 1) with a delay of 0.9 cannot be controlled with Ms <= 1.4.
  const PidOptimum none =
      max_integral_gain({kUnit, Eigen::Vector2d(1, -1), 0.9}, PidType::PI, {.Ms_max = 1.4});
  EXPECT_EQ(none.status, PidOptimumStatus::not_found) << none;
  EXPECT_TRUE(std::isnan(none.gains.Ki));
  EXPECT_THAT(none.culprit,
              HasSubstr("the search found no PI whose loop is stable with Ms <= 1.4"));
  const PidOptimum endless =
      max_integral_gain({kUnit, Eigen::Vector2d(1, 1), 0}, PidType::PI, {.Ms_max = 1.4});
  EXPECT_EQ(endless.status, PidOptimumStatus::unbounded) << endless;
}

// A controller that can make the loop K/s has no largest Ki: one with as many zeros as the plant
// has poles, if all zeros of the plant are stable.
// Gains within a tighter bound are within a looser one, however loose.
TEST(GreatestIntegralGain, GrowsWithTheBound) {
  const auto plant = [](std::initializer_list<double> den, double delay) {
    ContinuousTransferFunction g;
    g.num = Eigen::VectorXd::Ones(1);
    g.den = Eigen::VectorXd::Map(den.begin(), static_cast<Eigen::Index>(den.size()));
    g.delay = delay;
    return g;
  };
  const ContinuousTransferFunction plants[] = {plant({1, 1}, 1), plant({1, 3, 3, 1}, 0),
                                               plant({1, 0.4, 4}, 0.2)};
  for (const ContinuousTransferFunction& g : plants) {
    double smaller = 0;
    for (const double Ms : {1.4, 2.0, 3.0}) {
      PidBounds bounds;
      bounds.Ms_max = Ms;
      const PidOptimum optimum = max_integral_gain(g, PidType::PI, bounds);
      ASSERT_TRUE(optimum.solved()) << Ms << optimum.culprit;
      EXPECT_LE(optimum.Ms, 1.001 * Ms);
      EXPECT_GE(optimum.gains.Ki, 0.999 * smaller) << Ms;
      smaller = optimum.gains.Ki;
    }
  }
  // Bounds so loose that a search from the usual starts alone finds nothing.
  const PidOptimum tight = max_integral_gain(plants[0], PidType::PID, {.Ms_max = 3}, 0.1);
  const PidOptimum loose = max_integral_gain(plants[0], PidType::PID, {.Ms_max = 4}, 0.1);
  ASSERT_TRUE(tight.solved() && loose.solved()) << tight << loose;
  EXPECT_GE(loose.gains.Ki, tight.gains.Ki);
  const PidOptimum three_lags = max_integral_gain(plants[1], PidType::PI, {.Ms_max = 30});
  ASSERT_TRUE(three_lags.solved()) << three_lags;
  EXPECT_LT(three_lags.gains.Ki, 2.25);  // the largest Ki of any stable PI loop, by Routh
}

// The best Kp is almost 0: Ki has a maximum all the same.
TEST(GreatestIntegralGain, IsFoundForALightlyDampedPlantWithDelay) {
  ContinuousTransferFunction g;
  g.num = Eigen::VectorXd::Ones(1);
  g.den = Eigen::Vector3d(1, 0.4, 4);
  g.delay = 0.2;
  PidBounds bounds;
  bounds.Ms_max = 1.4;
  const PidOptimum optimum = max_integral_gain(g, PidType::PI, bounds);
  ASSERT_TRUE(optimum.solved()) << optimum.culprit;
  // A loop Ki/s G is stable up to Ki = 1.6 without the delay, by Routh.
  EXPECT_GT(optimum.gains.Ki, 0.36);
  EXPECT_LT(optimum.gains.Ki, 1.6);
}

TEST(GreatestIntegralGain, IsUnboundedWhereTheLoopCanBeAnIntegrator) {
  const auto status = [](const Eigen::VectorXd& num, const Eigen::VectorXd& den, PidType type,
                         double Tf = 0, PidBounds bounds = {.Ms_max = 1.4}) {
    return max_integral_gain({num, den, 0}, type, bounds, Tf).status;
  };
  const Eigen::Vector3d lags(1, 2, 1);
  constexpr auto kUnbounded = PidOptimumStatus::unbounded;
  EXPECT_EQ(status(kUnit, lags, PidType::PID), kUnbounded);
  EXPECT_EQ(status(Eigen::Vector2d(1, 3), lags, PidType::PI), kUnbounded);
  EXPECT_EQ(status(kUnit, Eigen::Vector2d(1, -1), PidType::PI), kUnbounded);
  // A second lag against a PI, the filter of the derivative, and a zero on the right bound it.
  EXPECT_EQ(status(kUnit, lags, PidType::PI), PidOptimumStatus::solved);
  EXPECT_EQ(status(kUnit, lags, PidType::PID, 0.1), PidOptimumStatus::solved);
  EXPECT_EQ(status(Eigen::Vector2d(-1, 3), lags, PidType::PI), PidOptimumStatus::solved);
  EXPECT_EQ(
      status(kUnit, Eigen::Vector2d(1, 1), PidType::PI, 0, {.Ms_max = 1.4, .noise_gain_max = 5}),
      PidOptimumStatus::solved);
}

TEST(GreatestIntegralGain, RejectsInvalidBounds) {
  EXPECT_THROW((void)max_integral_gain(three_equal_lags(), PidType::PD, {}), InvalidInput);
  EXPECT_THROW((void)max_integral_gain(three_equal_lags(), PidType::PI, {.Ms_max = 1}),
               InvalidInput);
  EXPECT_THROW((void)max_integral_gain(three_equal_lags(), PidType::PI, {.Mt_max = std::nan("")}),
               InvalidInput);
  EXPECT_THROW((void)max_integral_gain(three_equal_lags(), PidType::PID, {.noise_gain_max = 3}),
               InvalidInput);
  EXPECT_THROW((void)max_integral_gain(three_equal_lags(), PidType::PID, {}, -1), InvalidInput);
}

}  // namespace
}  // namespace quadtune
