// SPDX-License-Identifier: Apache-2.0
/// Step responses of closed loops against closed forms.
#include "quadtune/synthesis/pid/step_response.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::VectorXd;

VectorXd coefficients(std::initializer_list<double> values) {
  VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

ContinuousTransferFunction fraction_of(std::initializer_list<double> num,
                                       std::initializer_list<double> den, double delay = 0) {
  return {coefficients(num), coefficients(den), delay};
}

double max(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

// T = 1/(s + 1).
TEST(StepResponse, OfAnIntegratorIsExact) {
  const StepResponse response = step_response(OpenLoop(fraction_of({1}, {1, 0})));
  ASSERT_EQ(response.t.size(), response.y.size());
  EXPECT_EQ(response.t.front(), 0);
  EXPECT_GT(response.t.back(), 4);  // the time constant is 1 s: until 2 % and half as long again
  EXPECT_LT(response.t.back(), 10);
  for (std::size_t k = 0; k < response.t.size(); ++k)
    ASSERT_NEAR(response.y[k], 1 - std::exp(-response.t[k]), 1e-12);
}

// L = (s + 2)/(s + 1) passes the step on at once: T = (s + 2)/(2 s + 3).
TEST(StepResponse, OfAFeedThroughBeginsWithAJump) {
  const StepResponse response = step_response(OpenLoop(fraction_of({1, 2}, {1, 1})));
  for (std::size_t k = 0; k < response.t.size(); ++k)
    ASSERT_NEAR(response.y[k], 0.5 + (1 - std::exp(-1.5 * response.t[k])) / 6, 1e-12);
}

// By steps of the delay θ = 0.5 under L = e^(-θs)/s: 0, t - θ, then less (t - 2θ)²/2, ….
TEST(StepResponse, OfADelayedIntegratorFollowsThePolynomials) {
  const double delay = 0.5;
  const StepResponse response = step_response(OpenLoop(fraction_of({1}, {1, 0}, delay)), 0, 1.9);
  EXPECT_NEAR(response.t.back(), 1.9, 2e-3);
  for (std::size_t k = 0; k < response.t.size(); ++k) {
    const auto after = [&](int n) { return std::max(0.0, response.t[k] - n * delay); };
    const double exact = after(1) - std::pow(after(2), 2) / 2 + std::pow(after(3), 3) / 6;
    ASSERT_NEAR(response.y[k], exact, 1e-7) << response.t[k];
  }
}

// The feed-through of L = 0.5 (s + 2)/(s + 1) e^(-s) makes the response jump at each whole second.
TEST(StepResponse, KeepsJumpsSharp) {
  const StepResponse response = step_response(OpenLoop(fraction_of({0.5, 1}, {1, 1}, 1)), 0, 1.5);
  const auto at = std::find_if(response.t.begin(), response.t.end(),
                               [](double t) { return std::abs(t - 1) < 1e-9; });
  ASSERT_NE(at, response.t.end());
  const auto k = static_cast<std::size_t>(at - response.t.begin());
  EXPECT_EQ(response.t[k + 1], response.t[k]);
  EXPECT_EQ(response.y[k], 0);
  EXPECT_NEAR(response.y[k + 1], 0.5, 1e-12);
  // Before the second jump, the step response of L itself: 1 - 0.5 e^(-(t - 1)).
  EXPECT_NEAR(response.y.back(), 1 - 0.5 * std::exp(-(response.t.back() - 1)), 1e-9);
}

// T = 0.5/(z - 0.5) every 0.1 s.
TEST(StepResponse, OfADiscreteLoopIsItsRecursion) {
  const StepResponse response = step_response(
      OpenLoop(DiscreteTransferFunction{coefficients({0.5}), coefficients({1, -1}), 0.1, 0}));
  for (std::size_t k = 0; k < response.t.size(); ++k) {
    EXPECT_NEAR(response.t[k], 0.1 * static_cast<double>(k), 1e-12);
    ASSERT_NEAR(response.y[k], 1 - std::pow(0.5, static_cast<double>(k)), 1e-12);
  }
}

// Two decoupled integrators: the second is three times as fast.
TEST(StepResponse, OfOneChannelOfTwo) {
  ContinuousLti plant;
  plant.A = Eigen::MatrixXd::Zero(2, 2);
  plant.B = Eigen::MatrixXd::Identity(2, 2);
  plant.C = Eigen::Vector2d(1, 3).asDiagonal();
  const StepResponse response = step_response(OpenLoop(plant), 1, 2);
  EXPECT_NEAR(response.y.back(), 1 - std::exp(-6), 1e-12);
}

// The plant is 1/(s + 1), C = 2 + 3/s: s/(s² + 3 s + 3).
TEST(StepResponse, OfALoadVanishesWithTheIntegral) {
  const PidGains gains{2, 3, 0, 0};
  const StepResponse response = load_step_response(fraction_of({1}, {1, 1}), gains, 4);
  const double w = std::sqrt(3) / 2;
  for (std::size_t k = 0; k < response.t.size(); ++k) {
    const double t = response.t[k];
    ASSERT_NEAR(response.y[k], std::exp(-1.5 * t) * std::sin(w * t) / w, 1e-12);
  }
}

// Without noise, a fast derivative filter has no effect.
TEST(StepResponse, OfALoadIncludesTheDerivativeWithAndWithoutFilter) {
  const ContinuousTransferFunction plant = fraction_of({1}, {1, 0, 0});
  const StepResponse plain = load_step_response(plant, {4, 0, 3, 0}, 3);  // 1/(s² + 3 s + 4)
  const StepResponse filtered = load_step_response(plant, {4, 0, 3, 1e-6}, 3);
  const double w = std::sqrt(7) / 2;
  for (std::size_t k = 0; k < plain.t.size(); ++k) {
    const double t = plain.t[k];
    const double exact =
        (1 - std::exp(-1.5 * t) * (std::cos(w * t) + 1.5 / w * std::sin(w * t))) / 4;
    ASSERT_NEAR(plain.y[k], exact, 1e-12);
    ASSERT_NEAR(filtered.y[k], exact, 1e-5);
  }
}

// A load at the input of a plant with a negligible delay has the same response as without delay.
TEST(StepResponse, OfAShortDelayConvergesToThatWithout) {
  const PidGains gains{1, 1, 0.2, 0.1};
  const StepResponse without = load_step_response(fraction_of({1}, {1, 2, 1}), gains, 10);
  const StepResponse with = load_step_response(fraction_of({1}, {1, 2, 1}, 1e-3), gains, 10);
  EXPECT_NEAR(max(with.y), max(without.y), 1e-3);
  EXPECT_NEAR(with.y.back(), without.y.back(), 1e-3);
}

TEST(StepResponse, OfAnUnstableLoopStopsAtTheLimit) {
  const StepResponse response = step_response(OpenLoop(fraction_of({1}, {1, -2})));
  EXPECT_GT(max(response.y), 4);
  EXPECT_LT(max(response.y), 40);
  for (const double y : response.y) EXPECT_TRUE(std::isfinite(y));
}

TEST(StepResponse, ShowsFastMotionBeforeASlowTail) {
  // 0.01 s and 100 s: the tail is below 2 %.
  const StepResponse response = step_response(OpenLoop(fraction_of({100, 1.1}, {1, 0.0001, 0})));
  EXPECT_LT(response.t.back(), 1);
}

TEST(StepResponse, RejectsInvalidInput) {
  const OpenLoop loop(fraction_of({1}, {1, 0}));
  EXPECT_THROW((void)step_response(loop, 1), InvalidInput);
  EXPECT_THROW((void)step_response(loop, 0, -1), InvalidInput);
  EXPECT_THROW((void)step_response(loop, 0, std::nan("")), InvalidInput);
  // A derivative without filter of a plant with feed-through.
  EXPECT_THROW((void)load_step_response(fraction_of({1, 1}, {1, 2}), {1, 0, 1, 0}), InvalidInput);
}

}  // namespace
}  // namespace quadtune
