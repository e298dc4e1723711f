// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/suggest.hpp"

#include <gtest/gtest.h>

namespace quadtune::internal {
namespace {

TEST(Suggest, FindsAWordWithUpToAThirdOfWrongLetters) {
  const std::vector<std::string> vehicles = {"mambo", "rolling-spider", "uquad", "crazyflie"};
  EXPECT_EQ(nearest("manbo", vehicles), "mambo");
  EXPECT_EQ(nearest("uqad", vehicles), "uquad");
  EXPECT_EQ(nearest("crasyfly", vehicles), "crazyflie");  // 3 of 8
  EXPECT_EQ(nearest("crazyfly", vehicles), "crazyflie");
  EXPECT_EQ(nearest("rumba", vehicles), "");
}

TEST(Suggest, CountsTwoSwappedLettersAsOneMistake) {
  EXPECT_EQ(nearest("mabmo", {"mambo"}), "mambo");
  EXPECT_EQ(nearest("abmmo", {"mambo"}), "");
}

TEST(Suggest, ProposesNothingForAFewLettersHoweverManyDashes) {
  EXPECT_EQ(nearest("lqg", {"lqr"}), "");
  EXPECT_EQ(nearest("--W", {"--A", "--B", "--dt"}), "");
  EXPECT_EQ(nearest("--Ts", {"--Tf", "--Tu"}), "");
  EXPECT_EQ(nearest("--gians", {"--gains", "--json"}), "--gains");
}

TEST(Suggest, FindsTheShortestNameThatContainsTheWord) {
  EXPECT_EQ(nearest("--thrust", {"--thrust-to-weight", "--max-thrust", "--mass"}), "--max-thrust");
  EXPECT_EQ(nearest("--lag", {"--motor-lag"}), "");  // fewer than four letters
}

}  // namespace
}  // namespace quadtune::internal
