// SPDX-License-Identifier: Apache-2.0
#include "margins/brent_maximum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pid/golden_section.hpp"

namespace quadtune::internal {
namespace {

TEST(BrentMaximum, FindsTheTopOfACosine) {
  int count = 0;
  const auto f = [&](double x) {
    ++count;
    return std::cos(x - 0.3);
  };
  const auto [top, place] = brent_maximum(f, -1, 1, 1e-8);
  EXPECT_NEAR(top, 1, 1e-15);
  EXPECT_NEAR(place, 0.3, 1e-8);
  // A golden section has 40.
  EXPECT_LE(count, 16);
}

TEST(BrentMaximum, FindsTheEndThatIsHighest) {
  const auto rising = brent_maximum([](double x) { return x; }, 0, 1, 1e-6);
  EXPECT_NEAR(rising.second, 1, 1e-6);
  const auto falling = brent_maximum([](double x) { return -x; }, 0, 1, 1e-6);
  EXPECT_NEAR(falling.second, 0, 1e-6);
}

// Peaks of resonances between 1 and 1e-4 wide, where golden section finds them.
TEST(BrentMaximum, AgreesWithGoldenSection) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 200; ++i) {
    const double centre = uniform(random), width = std::pow(10, -4 * uniform(random));
    const auto f = [&](double x) { return 1 / std::hypot(x - centre, width); };
    const auto found = brent_maximum(f, 0, 1, 1e-6 * width);
    const auto golden = golden_section(f, 0, 1, 1e-6 * width);
    EXPECT_NEAR(found.first * width, 1, 1e-12) << i;
    EXPECT_NEAR(found.first, golden.first, 1e-12 * golden.first) << i;
  }
}

}  // namespace
}  // namespace quadtune::internal
