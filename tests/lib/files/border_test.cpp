// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/border.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace quadtune::internal {
namespace {

TEST(Border, EnclosesTheRootFromEitherSide) {
  const auto above = [](double x) { return x * x > 2; };
  const Border up = border(above, 3, 0, 1e-15);
  EXPECT_TRUE(above(up.holds));
  EXPECT_FALSE(above(up.fails));
  EXPECT_NEAR(up.holds, std::sqrt(2), 1e-14);
  const Border down = border([&](double x) { return !above(x); }, 0, 3, 1e-15);
  EXPECT_EQ(down.holds, up.fails);
  EXPECT_EQ(down.fails, up.holds);
}

TEST(Border, DoesNotEvaluateTheEnds) {
  const auto inside = [](double x) {
    EXPECT_TRUE(x > 1 && x < 8);
    return x < 5;
  };
  EXPECT_NEAR(border(inside, 1, 8, 1e-9).holds, 5, 1e-8);
}

// No relative width is reached at 0: the halvings have an end.
TEST(Border, EndsAtZero) {
  int count = 0;
  const auto never = [&](double) {
    ++count;
    return false;
  };
  EXPECT_LE(border(never, 0, 1, 1e-12).fails, 1e-17);
  EXPECT_LE(count, 60);
}

}  // namespace
}  // namespace quadtune::internal
