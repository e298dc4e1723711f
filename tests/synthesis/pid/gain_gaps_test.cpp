// SPDX-License-Identifier: Apache-2.0
#include "pid/gain_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace quadtune::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The intervals of g in which |larger|² < |smaller|² + min².
std::vector<GainInterval> forbidden_by(const AffineResponse& larger, const AffineResponse& smaller,
                                       double min) {
  std::vector<GainInterval> forbidden;
  forbid(larger, smaller, min, 3, forbidden);
  return forbidden;
}

TEST(GainGaps, ForbidWhereTheInequalityFails) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto complex = [&] { return std::complex<double>(normal(random), normal(random)); };
  int inside = 0, outside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const AffineResponse larger{complex(), complex()}, smaller{complex(), complex()};
    const double min = std::abs(normal(random));
    const std::vector<GainInterval> forbidden = forbidden_by(larger, smaller, min);
    const double g = std::exp(2 * normal(random));
    const double excess = std::norm(larger.alpha + larger.beta * g) -
                          std::norm(smaller.alpha + smaller.beta * g) - min * min;
    if (std::abs(excess) < 1e-9 * (1 + g * g)) continue;
    bool is_forbidden = false;
    for (const GainInterval& interval : forbidden) {
      EXPECT_EQ(interval.w, 3);
      is_forbidden |= interval.low < g && g < interval.high;
    }
    EXPECT_EQ(is_forbidden, excess < 0) << trial;
    ++(is_forbidden ? inside : outside);
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

// |1 - g|² ≥ |g|² + min² up to g = (1 - min²)/2, and |1 + g|² ≥ |g|² + min² from -(1 - min²)/2 on.
TEST(GainGaps, OfResponsesThatGrowEqually) {
  const auto up = forbidden_by({1, -1}, {0, 1}, 0.5);
  ASSERT_EQ(up.size(), 1U);
  EXPECT_DOUBLE_EQ(up[0].low, 0.375);
  EXPECT_EQ(up[0].high, kInfinity);
  const auto down = forbidden_by({1, 1}, {0, 1}, 2);
  ASSERT_EQ(down.size(), 1U);
  EXPECT_EQ(down[0].low, 0);
  EXPECT_DOUBLE_EQ(down[0].high, 1.5);
}

// If the two responses grow almost equally, one root is far away; the near one, (min² - α²)/(2 α),
// keeps its digits for either sign of the linear term.
TEST(GainGaps, KeepTheDigitsOfTheNearRoot) {
  const double more = 1 + std::numeric_limits<double>::epsilon();
  {
    // (0.3 + g)² ≥ (g (1 + ε))² + 1 from g = 0.91/0.6 on, to the far root.
    const auto forbidden = forbidden_by({0.3, 1}, {0, more}, 1);
    ASSERT_EQ(forbidden.size(), 2U);
    EXPECT_NEAR(forbidden[0].high, 0.91 / 0.6, 1e-14);
    EXPECT_GT(forbidden[1].low, 1e14);
    EXPECT_EQ(forbidden[1].high, kInfinity);
  }
  {
    // (g (1 + ε) - 0.3)² ≥ g² up to g = 0.15, and beyond the far root.
    const auto forbidden = forbidden_by({-0.3, more}, {0, 1}, 0);
    ASSERT_EQ(forbidden.size(), 1U);
    EXPECT_NEAR(forbidden[0].low, 0.15, 1e-14);
    EXPECT_GT(forbidden[0].high, 1e14);
  }
}

}  // namespace
}  // namespace quadtune::internal
