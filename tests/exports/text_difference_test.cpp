// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/text_difference.hpp"

#include <gmock/gmock.h>

namespace quadtune {
namespace {

using ::testing::DoubleNear;
using ::testing::Optional;

TEST(TextDifference, NamesTheFirstLineThatDiffers) {
  EXPECT_EQ(first_other_line("a\nb\n", "a\nb\n"), 0U);
  EXPECT_EQ(first_other_line("a\nb\n", "a\nc\n"), 2U);
  EXPECT_EQ(first_other_line("a\n", "a\nb\n"), 2U);
}

TEST(TextDifference, OfNumbersIsRelativeToTheLargestOfTheirLine) {
  EXPECT_THAT(numbers_apart("K = [1.0, 2e3]\n", "K = [1.0, 2e3]\n"), Optional(0.0));
  EXPECT_THAT(numbers_apart("1 1000\n7\n", "2 1000\n7\n"), Optional(DoubleNear(1e-3, 1e-15)));
  // Rounding can change the sign of small numbers, and columns keep their width.
  EXPECT_THAT(numbers_apart("  1.0  -5e-17\n", "  1.0       0.0\n"),
              Optional(DoubleNear(5e-17, 1e-20)));
  EXPECT_THAT(numbers_apart("[-1, 2]", "[1, 2]"), Optional(DoubleNear(1, 1e-15)));
}

TEST(TextDifference, OfWordsHasNoSize) {
  EXPECT_EQ(numbers_apart("mass 1\n", "weight 1\n"), std::nullopt);
  EXPECT_EQ(numbers_apart("w1 = 2\n", "w2 = 2\n"), std::nullopt);  // digits of a name
  EXPECT_EQ(numbers_apart("1 2\n", "1\n"), std::nullopt);
  EXPECT_EQ(numbers_apart("1\n", "1\n2\n"), std::nullopt);
  EXPECT_EQ(numbers_apart("butter(3, 0.01)", "butter(3, 1e999)"), std::nullopt);
}

}  // namespace
}  // namespace quadtune
