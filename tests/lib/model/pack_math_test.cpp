// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/pack_math.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "numbers.hpp"
#include "same_bits.hpp"

namespace quadtune {
namespace {

using testing::same_bits;

using testing::kInfinity;
using testing::kNaN;
using testing::kPi;

// How far `got` is from `want`, in units in the last place of `want`.
double ulps(double got, long double want) {
  if (static_cast<long double>(got) == want) return 0;
  const double ulp = std::ldexp(1.0, std::max(std::ilogb(want), -1022) - 52);
  return static_cast<double>(std::abs(static_cast<long double>(got) - want)) / ulp;
}

double draw(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Both signs, sizes from 2^low to 2^high evenly in the exponent.
std::vector<double> sizes(int low, int high, int count) {
  std::mt19937_64 random(1);
  std::vector<double> all(static_cast<std::size_t>(count));
  double sign = -1;
  for (double& size : all) size = (sign = -sign) * std::exp2(draw(random, low, high));
  return all;
}

// f of every x in every lane of 1, 2, 4 and 8, all with the same bytes; returns the worst error.
template <class Packed, class Exact>
double worst(const std::vector<double>& all, Packed&& packed, Exact&& exact) {
  double worst = 0;
  const auto lanes = [&](auto count, std::size_t i, double alone) {
    constexpr int N = decltype(count)::value;
    Pack<N> x = 0;
    for (int l = 0; l < N; ++l) set_lane(x, l, all[(i + static_cast<std::size_t>(l)) % all.size()]);
    const Pack<N> y = packed(x);
    EXPECT_TRUE(same_bits(lane(y, 0), alone)) << N << " lanes at " << all[i];
    return lane(y, N - 1);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double alone = lane(packed(Pack<1>(all[i])), 0);
    for (const double last : {lanes(std::integral_constant<int, 2>(), i, alone),
                              lanes(std::integral_constant<int, 4>(), i, alone),
                              lanes(std::integral_constant<int, 8>(), i, alone)})
      (void)last;
    const double error = ulps(alone, exact(static_cast<long double>(all[i])));
    EXPECT_FALSE(std::isnan(error)) << all[i];
    if (error > worst) worst = error;
  }
  return worst;
}
#define WORST(f, all) \
  worst(              \
      all, [](const auto& x) { return f(x); }, [](long double x) { return std::f(x); })

std::vector<double> angles() {
  std::vector<double> all = sizes(-40, 17, 20000);
  for (int k = -2000; k <= 2000; ++k)  // next to where they cross 0, where a reduction loses most
    for (const double off : {-1e-9, 0.0, 1e-9}) all.push_back(k * kPi / 2 + off);
  for (int i = 0; i < 1000; ++i)  // 3 to 6e4
    all.push_back(std::floor(3 * std::pow(1.01, i)) * kPi / 2);
  return all;
}

TEST(PackMath, SinesAndCosinesAreWithinTwoUnits) {
  EXPECT_LT(WORST(sin, angles()), 2);
  EXPECT_LT(WORST(cos, angles()), 2);
  EXPECT_LT(WORST(tan, angles()), 4);  // of two of these
}

TEST(PackMath, ArcFunctionsAreWithinTwoUnits) {
  EXPECT_LT(WORST(atan, sizes(-40, 40, 20000)), 2);
  std::mt19937_64 random(2);
  std::vector<double> shares = sizes(-40, 0, 10000);
  for (int i = 0; i < 10000; ++i) shares.push_back(draw(random, -1, 1));
  for (int i = 0; i < 1000; ++i) shares.push_back(1 - std::exp2(-i / 20.0 - 3));
  EXPECT_LT(WORST(asin, shares), 3);  // and the rounding of the root
  EXPECT_LT(WORST(acos, shares), 3);
}

TEST(PackMath, ArcTangentOfTwoKnowsItsQuadrant) {
  std::mt19937_64 random(3);
  double max = 0;
  for (int i = 0; i < 40000; ++i) {
    const double y = (i & 1 ? -1 : 1) * std::exp2(draw(random, -30, 30));
    const double x = (i & 2 ? -1 : 1) * std::exp2(draw(random, -30, 30));
    const Pack<4> packed = atan2(Pack<4>(y), Pack<4>(x));
    const double alone = lane(atan2(Pack<1>(y), Pack<1>(x)), 0);
    ASSERT_TRUE(same_bits(lane(packed, i % 4), alone));
    max = std::max(max, ulps(alone, std::atan2(static_cast<long double>(y), x)));
  }
  EXPECT_LT(max, 2.5);
  const auto at = [](double y, double x) { return lane(atan2(Pack<1>(y), Pack<1>(x)), 0); };
  EXPECT_EQ(at(0, 1), 0);
  EXPECT_EQ(at(0, -1), kPi);
  EXPECT_EQ(at(-0.0, -1), kPi);  // the sign of zero is ignored
  EXPECT_EQ(at(1, 0), kPi / 2);
  EXPECT_EQ(at(-1, 0), -kPi / 2);
  EXPECT_EQ(at(1, -0.0), kPi / 2);
  EXPECT_EQ(at(0, 0), 0);
  EXPECT_EQ(at(1, 1), kPi / 4);
  EXPECT_EQ(at(-1, -1), -kPi + kPi / 4);
  EXPECT_EQ(at(1, kInfinity), 0);
  EXPECT_EQ(at(1, -kInfinity), kPi);
  EXPECT_EQ(at(-kInfinity, 1), -kPi / 2);
  EXPECT_TRUE(std::isnan(at(kInfinity, kInfinity)));
  EXPECT_TRUE(std::isnan(at(kNaN, 1)));
  EXPECT_TRUE(std::isnan(at(1, kNaN)));
  EXPECT_TRUE(std::isnan(at(0, kNaN)));
}

TEST(PackMath, LogarithmsAndExponentialsAreWithinTwoUnits) {
  std::mt19937_64 random(4);
  std::vector<double> positive;
  for (const double x : sizes(-1021, 1023, 20000)) positive.push_back(std::abs(x));
  for (int i = 0; i < 20000; ++i) positive.push_back(draw(random, 0.5, 2));  // near its zero
  EXPECT_LT(WORST(log, positive), 2);
  std::vector<double> exponents = sizes(-40, 6, 10000);
  for (int i = 0; i < 20000; ++i) exponents.push_back(draw(random, -708, 709));
  EXPECT_LT(WORST(exp, exponents), 2);
}

// exp(y log x): what the logarithm leaves is multiplied by y.
TEST(PackMath, PowersAreAsGoodAsTheirExponentIsSmall) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20000; ++i) {
    const double x = std::exp2(draw(random, -20, 20)), y = draw(random, -6, 6);
    const double got = lane(pow(Pack<1>(x), Pack<1>(y)), 0);
    ASSERT_TRUE(same_bits(lane(pow(Pack<8>(x), Pack<8>(y)), 5), got));
    EXPECT_LT(ulps(got, std::pow(static_cast<long double>(x), y)),
              3 + 3 * std::abs(y * std::log(x)))
        << x << " " << y;
  }
}

TEST(PackMath, KnowsInfinitiesAndWhatIsNoNumber) {
  const auto of = [](auto f, double x) { return lane(f(Pack<2>(x)), 1); };
  const auto sine = [](auto x) { return sin(x); };
  const auto cosine = [](auto x) { return cos(x); };
  const auto arc = [](auto x) { return atan(x); };
  const auto arc_sine = [](auto x) { return asin(x); };
  const auto arc_cosine = [](auto x) { return acos(x); };
  const auto logarithm = [](auto x) { return log(x); };
  const auto exponential = [](auto x) { return exp(x); };
  for (const double x : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_TRUE(std::isnan(of(sine, x))) << x;
    EXPECT_TRUE(std::isnan(of(cosine, x))) << x;
    EXPECT_TRUE(std::isnan(of(arc_sine, x))) << x;
    EXPECT_TRUE(std::isnan(of(arc_cosine, x))) << x;
  }
  EXPECT_EQ(of(sine, 0), 0);
  EXPECT_EQ(of(cosine, 0), 1);
  EXPECT_EQ(of(arc, kInfinity), kPi / 2);
  EXPECT_EQ(of(arc, -kInfinity), -kPi / 2);
  EXPECT_TRUE(std::isnan(of(arc, kNaN)));
  EXPECT_EQ(of(arc_sine, 1), kPi / 2);
  EXPECT_EQ(of(arc_sine, -1), -kPi / 2);
  EXPECT_EQ(of(arc_cosine, 1), 0);
  EXPECT_EQ(of(arc_cosine, -1), kPi);
  EXPECT_TRUE(std::isnan(of(arc_sine, 1.0000001)));
  EXPECT_TRUE(std::isnan(of(arc_cosine, -1.0000001)));
  EXPECT_EQ(of(logarithm, 0), -kInfinity);
  EXPECT_EQ(of(logarithm, 1), 0);
  EXPECT_EQ(of(logarithm, kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(of(logarithm, -1)));
  EXPECT_TRUE(std::isnan(of(logarithm, kNaN)));
  EXPECT_EQ(of(exponential, 0), 1);
  EXPECT_EQ(of(exponential, -kInfinity), 0);
  EXPECT_EQ(of(exponential, -709), 0);
  EXPECT_EQ(of(exponential, kInfinity), kInfinity);
  EXPECT_EQ(of(exponential, 710), kInfinity);
  EXPECT_TRUE(std::isnan(of(exponential, kNaN)));
}

}  // namespace
}  // namespace quadtune
