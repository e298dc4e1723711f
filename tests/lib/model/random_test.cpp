// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/random.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <vector>

namespace quadtune {
namespace {

using Four = std::array<std::uint32_t, 4>;

// [Salmon11], the known answers of Random123 for philox4x32 with ten rounds.
static_assert(philox({0, 0, 0, 0}, {0, 0}) == Four{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
static_assert(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
              Four{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
static_assert(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
              Four{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});

TEST(Random, UniformNumbersAreTheWordsOfPhilox) {
  for (const std::uint64_t index : {0ULL, 1ULL, 0x123456789abcULL, ~0ULL}) {
    const RandomSource<1> source{0x0123456789abcdefULL, {77}};
    const Four words =
        philox({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), 5, 77},
               {0x89abcdef, 0x01234567});
    const auto number = [](std::uint32_t low, std::uint32_t high) {
      const std::uint64_t bits = ((static_cast<std::uint64_t>(high) << 32) | low) >> 12;
      return (static_cast<double>(bits) + 0.5) * std::ldexp(1.0, -52);
    };
    const RandomPair<1> pair = random_uniform(source, 5, index);
    EXPECT_EQ(lane(pair.first, 0), number(words[0], words[1]));
    EXPECT_EQ(lane(pair.second, 0), number(words[2], words[3]));
  }
}

TEST(Random, EachLaneIsTheFlightAlone) {
  RandomSource<8> eight{99, {3, 1, 4, 1, 5, 9, 2, 6}};
  for (std::uint64_t index = 0; index < 1000; ++index) {
    const RandomPair<8> normal = random_normal(eight, 7, index);
    const RandomPair<8> uniform = random_uniform(eight, 7, index);
    for (int l = 0; l < 8; ++l) {
      const RandomSource<1> one{99, {eight.flight[static_cast<std::size_t>(l)]}};
      ASSERT_EQ(lane(normal.first, l), lane(random_normal(one, 7, index).first, 0));
      ASSERT_EQ(lane(normal.second, l), lane(random_normal(one, 7, index).second, 0));
      ASSERT_EQ(lane(uniform.first, l), lane(random_uniform(one, 7, index).first, 0));
    }
  }
}

constexpr int kCount = 1 << 20;

std::vector<double> normals(std::uint64_t seed, std::uint32_t flight, std::uint32_t stream) {
  std::vector<double> all;
  all.reserve(kCount);
  for (std::uint64_t i = 0; i < kCount / 2; ++i) {
    const RandomPair<1> pair = random_normal(RandomSource<1>{seed, {flight}}, stream, i);
    all.push_back(lane(pair.first, 0));
    all.push_back(lane(pair.second, 0));
  }
  return all;
}

// Each figure within five standard deviations of what it is on average.
TEST(Random, NormalNumbersHaveTheMomentsOfTheirLaw) {
  const std::vector<double> all = normals(1, 0, 0);
  std::array<double, 5> moment{};
  int beyond_two = 0, beyond_four = 0;
  for (const double x : all) {
    for (std::size_t k = 1; k < 5; ++k) moment[k] += std::pow(x, k) / kCount;
    beyond_two += std::abs(x) > 2 ? 1 : 0;
    beyond_four += std::abs(x) > 4 ? 1 : 0;
  }
  const double root = std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(moment[1], 0, 5 / root);
  EXPECT_NEAR(moment[2], 1, 5 * std::sqrt(2.0) / root);
  EXPECT_NEAR(moment[3], 0, 5 * std::sqrt(15.0) / root);
  EXPECT_NEAR(moment[4], 3, 5 * std::sqrt(96.0) / root);
  const auto expect_share = [&](int count, double share) {
    EXPECT_NEAR(count, share * kCount, 5 * std::sqrt(share * kCount));
  };
  expect_share(beyond_two, std::erfc(2 / std::sqrt(2.0)));
  expect_share(beyond_four, std::erfc(4 / std::sqrt(2.0)));
}

TEST(Random, UniformNumbersFillTheirRangeEvenly) {
  std::array<int, 64> bins{};
  for (std::uint64_t i = 0; i < kCount / 2; ++i) {
    const RandomPair<1> pair = random_uniform(RandomSource<1>{5, {2}}, 3, i);
    for (const double x : {lane(pair.first, 0), lane(pair.second, 0)}) {
      ASSERT_GT(x, 0);
      ASSERT_LT(x, 1);
      ++bins[static_cast<std::size_t>(x * 64)];
    }
  }
  double chi_square = 0;
  for (const int count : bins) chi_square += std::pow(count - kCount / 64.0, 2) / (kCount / 64.0);
  EXPECT_NEAR(chi_square, 63, 5 * std::sqrt(2 * 63.0));
}

TEST(Random, StreamsFlightsSeedsAndSamplesKnowNothingOfEachOther) {
  const std::vector<double> here = normals(1, 0, 0);
  const auto correlation = [&](const std::vector<double>& there, std::size_t lag) {
    double sum = 0;
    for (std::size_t i = lag; i < here.size(); ++i) sum += here[i] * there[i - lag];
    return sum / std::sqrt(static_cast<double>(kCount));  // standard deviation 1
  };
  for (const std::size_t lag : {1u, 2u, 3u, 8u}) EXPECT_LT(std::abs(correlation(here, lag)), 5);
  const std::vector<std::vector<double>> others = {normals(1, 0, 1), normals(1, 1, 0),
                                                   normals(2, 0, 0), normals(1ULL << 32, 0, 0)};
  for (const std::vector<double>& there : others)
    for (const std::size_t lag : {0u, 1u, 2u}) EXPECT_LT(std::abs(correlation(there, lag)), 5);
}

}  // namespace
}  // namespace quadtune
