// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pid/loop_shape.hpp"

namespace quadtune::internal {
namespace {

using std::numbers::pi;
const Eigen::VectorXd kOneGain = Eigen::VectorXd::Ones(1);

// 1/s e^(-L s) under K is stable for K L < π/2, by its characteristic equation s + K e^(-L s) = 0.
TEST(LoopShape, FindsTheStabilityLimitWithDelay) {
  const LoopShape shape({kOneGain, Eigen::Vector2d(1, 0), 0.5}, {});
  EXPECT_TRUE(shape.stable({(pi - 1e-4), 0, 0, 0}));
  EXPECT_FALSE(shape.stable({(pi + 1e-4), 0, 0, 0}));
  EXPECT_FALSE(shape.stable({-1, 0, 0, 0}));
  EXPECT_FALSE(shape.stable({100, 0, 0, 0}));
}

// e^(-L s)/(s - 1) under K: stable between K = 1 and the K whose crossover √(K² - 1) has the phase
// atan ω = ω L.
TEST(LoopShape, FindsTheStabilityLimitsOfAnUnstablePlantWithDelay) {
  const double L = 0.3;
  const LoopShape shape({kOneGain, Eigen::Vector2d(1, -1), L}, {});
  double low = 1;
  double high = 10;
  for (int i = 0; i < 100; ++i) {
    const double w = (low + high) / 2;
    (std::atan(w) > w * L ? low : high) = w;
  }
  const double K = std::sqrt(1 + low * low);
  EXPECT_FALSE(shape.stable({0.999, 0, 0, 0}));
  EXPECT_TRUE(shape.stable({1.001, 0, 0, 0}));
  EXPECT_TRUE(shape.stable({0.999 * K, 0, 0, 0}));
  EXPECT_FALSE(shape.stable({1.001 * K, 0, 0, 0}));
}

// With a negligible delay, Mikhailov's criterion agrees with the roots of the polynomial.
TEST(LoopShape, MikhailovAgreesWithTheRoots) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  int stable = 0;
  for (int i = 0; i < 300; ++i) {
    ContinuousTransferFunction plant;
    plant.num = Eigen::Vector2d(normal(random), normal(random));
    plant.den = Eigen::Vector4d(1, 1 + normal(random), 1 + normal(random), 1 + normal(random));
    const PidGains gains = {std::abs(normal(random)), std::abs(normal(random)),
                            std::abs(normal(random)), 0.1};
    const bool without = LoopShape(plant, {}).stable(gains);
    plant.delay = 1e-7;
    EXPECT_EQ(LoopShape(plant, {}).stable(gains), without) << i;
    stable += without;
  }
  EXPECT_GT(stable, 30);
  EXPECT_LT(stable, 270);
}

// T of 1/(s (s + 2 zeta)) under P 1: Mt = 1/(2 zeta √(1 - zeta²)) at √(1 - 2 zeta²).
TEST(LoopShape, FindsTheResonanceOfASecondOrderLoop) {
  for (const double zeta : {0.001, 0.05, 0.3, 0.6}) {
    const LoopShape shape({kOneGain, Eigen::Vector3d(1, 2 * zeta, 0), 0}, {1});
    const SensitivityPeaks peaks = shape.peaks({1, 0, 0, 0});
    const double exact = 1 / (2 * zeta * std::sqrt(1 - zeta * zeta));
    EXPECT_NEAR(peaks.Mt, exact, 1e-9 * exact) << zeta;
    EXPECT_NEAR(peaks.w_Mt, std::sqrt(1 - 2 * zeta * zeta), 1e-6);
  }
}

TEST(LoopShape, FindsTheMinimumPhaseMargin) {
  // 2/(s (s + 1)) crosses at ω² = (√17 - 1)/2 with 90° - atan ω.
  const LoopShape shape({Eigen::VectorXd::Constant(1, 2), Eigen::Vector3d(1, 1, 0), 0}, {});
  const double w = std::sqrt((std::sqrt(17.0) - 1) / 2);
  const MinPhaseMargin min = shape.min_phase_margin({1, 0, 0, 0});
  EXPECT_NEAR(min.w, w, 1e-12);
  EXPECT_NEAR(min.margin, pi / 2 - std::atan(w), 1e-12);
}

TEST(LoopShape, RejectsImproperLoopsAndCancelledIntegrals) {
  EXPECT_FALSE(LoopShape({kOneGain, kOneGain, 0}, {}).stable({1, 0, 1, 0}));
  EXPECT_FALSE(
      LoopShape({Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 1), 0}, {}).stable({1, 1, 0, 0}));
  // 2 s/(s + 1) e^(-s) has |L| = 2 at the top: infinitely many poles in the right half-plane.
  EXPECT_FALSE(
      LoopShape({Eigen::Vector2d(2, 0.1), Eigen::Vector2d(1, 1), 1}, {}).stable({1, 0, 0, 0}));
}

}  // namespace
}  // namespace quadtune::internal
