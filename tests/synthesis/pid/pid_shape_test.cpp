// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pid/loop_shape.hpp"
#include "quadtune/synthesis/margins.hpp"
#include "quadtune/synthesis/open_loop.hpp"

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

/// Follows arg F(jω), F = den + num e^(-jω delay), in steps short enough for the delay and the
/// roots, up to where |L| is below 1/2, and returns the number of roots in the right half-plane.
/// A second method for stable_with_delay().
double roots_in_the_right_half(const ContinuousTransferFunction& loop) {
  const auto F = [&](double w) {
    return polynomial(loop.den, {0, w}) +
           polynomial(loop.num, {0, w}) * std::polar(1.0, -w * loop.delay);
  };
  const auto size = [&](double w) {
    return std::abs(polynomial(loop.num, {0, w}) / polynomial(loop.den, {0, w}));
  };
  double end = 1e3;
  while (!(size(end) < 0.9)) end *= 2;
  double total = 0;
  double w = 0;
  for (std::complex<double> f = F(0); w < end;) {
    double step = std::min(1e-3 * std::max(w, 1e-2), 0.05 / loop.delay);
    std::complex<double> next = F(w + step);
    while (std::abs(std::arg(next / f)) > 0.3 && step > 1e-12 * w) {
      step /= 2;
      next = F(w + step);
    }
    total += std::arg(next / f);
    f = next;
    w += step;
  }
  for (const std::complex<double>& root : polynomial_roots(loop.den)) {
    const double rest = pi / 2 - std::atan2(w - root.imag(), std::abs(root.real()));
    total += root.real() > 0 ? -rest : rest;
  }
  total -= std::arg(1.0 + loop({0, w}));
  const auto n = static_cast<double>(loop.den.size() - 1);
  return (n * pi / 2 - total) / pi;
}

// Plants with lightly damped poles and zeros, unstable poles and integrators, under PI and PID with
// and without a filter, with delays from a thousandth of the plant's times to twenty of them.
TEST(LoopShape, ClosedFormAgreesWithFollowingTheArgument) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform;
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, uniform(random));
  };
  const auto quadratic = [&] {
    const double w = between(0.3, 10), zeta = between(0.003, 1);
    return Eigen::Vector3d(1, (uniform(random) < 0.2 ? -2 : 2) * zeta * w, w * w);
  };
  int stable = 0, compared = 0;
  for (int i = 0; i < 250; ++i) {
    ContinuousTransferFunction plant;
    plant.num = uniform(random) < 0.5 ? Eigen::VectorXd(kOneGain * between(0.1, 10))
                                      : Eigen::VectorXd(quadratic());
    plant.den = polynomial_product(
        quadratic(), Eigen::Vector2d(1, uniform(random) < 0.3 ? 0 : between(0.1, 10)));
    plant.delay = between(1e-3, 20);
    const double gain = plant.den.tail(1)[0] == 0 ? 1 : plant.den.tail(1)[0];
    PidGains gains;
    gains.Kp = gain / plant.num.tail(1)[0] * between(0.01, 3);
    if (uniform(random) < 0.7) gains.Ki = gains.Kp * between(0.001, 1) / std::max(plant.delay, 1.0);
    if (uniform(random) < 0.5) gains.Kd = gains.Kp * between(0.01, 1);
    if (uniform(random) < 0.5) gains.Tf = between(0.001, 0.1);
    const ContinuousTransferFunction loop = loop_of(plant, gains);
    const LoopShape shape(plant, {gains.Tf > 0 ? 1 / gains.Tf : 1});
    if (loop.num.size() == loop.den.size() && !(std::abs(loop.num[0]) < 0.95 * loop.den[0])) {
      if (std::abs(loop.num[0]) >= loop.den[0]) {
        EXPECT_FALSE(shape.stable(gains)) << i;
      }
      continue;
    }
    const double right = roots_in_the_right_half(loop);
    if (std::abs(right - std::round(right)) > 1e-3) continue;  // on the border
    EXPECT_EQ(shape.stable(gains), std::round(right) == 0)
        << i << ": " << right << ", " << gains << ", delay " << plant.delay << "\nnum "
        << plant.num.transpose() << "\nden " << plant.den.transpose();
    // margins() counts the roots that cross the axis as the delay increases from 0.
    EXPECT_EQ(shape.stable(gains), loop_margins(OpenLoop(loop)).stable) << i;
    stable += std::round(right) == 0;
    ++compared;
  }
  EXPECT_GT(compared, 150);
  EXPECT_GT(stable, 40);
  EXPECT_LT(stable, compared - 40);
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
