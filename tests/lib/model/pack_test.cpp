// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/pack.hpp"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <vector>

#include "numbers.hpp"
#include "same_bits.hpp"

namespace quadtune {
namespace {

using testing::same_bits;

using testing::kInfinity;
using testing::kNaN;

std::vector<double> numbers() {
  std::vector<double> all = {0.0,        -0.0,
                             1.0,        -1.0,
                             kInfinity,  kNaN,
                             3,          -1e10,
                             -kInfinity, std::numeric_limits<double>::max(),
                             -1.5,       0.1,
                             1e-10,      std::numeric_limits<double>::denorm_min(),
                             -2e300};
  std::mt19937_64 random(1);
  for (int i = 0; i < 25; ++i)
    all.push_back(std::ldexp(std::uniform_real_distribution<double>(-1, 1)(random), i * 7 - 80));
  return all;
}

template <class T>
class PackOf : public ::testing::Test {};
template <int N>
using Lanes = std::integral_constant<int, N>;
using LaneCounts = ::testing::Types<Lanes<1>, Lanes<2>, Lanes<4>, Lanes<8>>;
TYPED_TEST_SUITE(PackOf, LaneCounts);

// Every pair of numbers in some lane, with its neighbours in the others.
template <int N, class Check>
void for_all_pairs(const Check& check) {
  const std::vector<double> all = numbers();
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j) {
      Pack<N> a = 0, b = 0;
      for (int l = 0; l < N; ++l) {
        const auto k = static_cast<std::size_t>(l);
        set_lane(a, l, all[(i + k) % all.size()]);
        set_lane(b, l, all[(j + 3 * k) % all.size()]);
      }
      check(a, b);
    }
}

#define EXPECT_LANES(packed, scalar)                                                        \
  for (int l = 0; l < N; ++l) {                                                             \
    const double x = lane(a, l), y = lane(b, l);                                            \
    (void)y;                                                                                \
    ASSERT_TRUE(same_bits(lane(packed, l), scalar)) << #scalar << " of " << x << ", " << y; \
  }
#define EXPECT_MASKS(packed, scalar)                                             \
  for (int l = 0; l < N; ++l) {                                                  \
    const double x = lane(a, l), y = lane(b, l);                                 \
    (void)y;                                                                     \
    ASSERT_EQ(lane(packed, l), (scalar)) << #scalar << " of " << x << ", " << y; \
  }

TYPED_TEST(PackOf, NumbersIsThatOfEachNumber) {
  constexpr int N = TypeParam::value;
  for_all_pairs<N>([](Pack<N> a, Pack<N> b) {
    EXPECT_LANES(a + b, x + y);
    EXPECT_LANES(a - b, x - y);
    EXPECT_LANES(a * b, x * y);
    EXPECT_LANES(a / b, x / y);
    EXPECT_LANES(-a, -x);
    EXPECT_LANES(+a, x);
    EXPECT_LANES(min_of(a, b), min_of(x, y));
    EXPECT_LANES(max_of(a, b), max_of(x, y));
    EXPECT_LANES(clamped(a, b, Pack<N>(b + Pack<N>(1))), clamped(x, y, y + 1));
    EXPECT_LANES(select(a < b, a, b), select(x < y, x, y));
    EXPECT_LANES(sqrt(a), std::sqrt(x));
  });
}

TYPED_TEST(PackOf, NumbersAssignsAsItOperates) {
  constexpr int N = TypeParam::value;
  for_all_pairs<N>([](Pack<N> a, Pack<N> b) {
    Pack<N> sum = a, difference = a, product = a, ratio = a;
    sum += b;
    difference -= b;
    product *= b;
    ratio /= b;
    EXPECT_LANES(sum, x + y);
    EXPECT_LANES(difference, x - y);
    EXPECT_LANES(product, x * y);
    EXPECT_LANES(ratio, x / y);
  });
}

TYPED_TEST(PackOf, NumbersComparesEachOfThem) {
  constexpr int N = TypeParam::value;
  for_all_pairs<N>([](Pack<N> a, Pack<N> b) {
    EXPECT_MASKS(a < b, x < y);
    EXPECT_MASKS(a <= b, x <= y);
    EXPECT_MASKS(a > b, x > y);
    EXPECT_MASKS(a >= b, x >= y);
    EXPECT_MASKS(a == b, x == y);
    EXPECT_MASKS(a != b, x != y);
    EXPECT_MASKS(is_finite(a), std::isfinite(x));
    EXPECT_MASKS(logical_and(a<b, b> Pack<N>(0)), x < y && y > 0);
    EXPECT_MASKS(logical_or(a<b, b> Pack<N>(0)), x < y || y > 0);
    EXPECT_MASKS(logical_not(a < b), !(x < y));
    EXPECT_MASKS(select(a<b, a> Pack<N>(0), b > Pack<N>(0)), x < y ? x > 0 : y > 0);
    bool some = false, every = true;
    for (int l = 0; l < N; ++l) {
      some = some || lane(a, l) < lane(b, l);
      every = every && lane(a, l) < lane(b, l);
    }
    ASSERT_EQ(any(a < b), some);
    ASSERT_EQ(all(a < b), every);
  });
}

// Except for the sign of a zero, as documented.
TYPED_TEST(PackOf, NumbersHasTheirMagnitudesAndNearestIntegers) {
  constexpr int N = TypeParam::value;
  for_all_pairs<N>([](Pack<N> a, Pack<N> b) {
    (void)b;
    for (int l = 0; l < N; ++l) {
      const double x = lane(a, l);
      if (std::isnan(x)) {
        EXPECT_TRUE(std::isnan(lane(abs_of(a), l)));
        EXPECT_TRUE(std::isnan(lane(nearest(a), l)));
        continue;
      }
      EXPECT_EQ(lane(abs_of(a), l), std::abs(x));
      if (std::abs(x) < 2251799813685248.0) {
        EXPECT_EQ(lane(nearest(a), l), std::nearbyint(x));
      }
    }
  });
  for (const double tie : {0.5, 1.5, 2.5, -0.5, -1.5, -2.5, 1048576.5})
    EXPECT_EQ(lane(nearest(Pack<N>(tie)), N - 1), std::nearbyint(tie));  // ties to even
}

TYPED_TEST(PackOf, NumbersSetsOneLaneAlone) {
  constexpr int N = TypeParam::value;
  for (int which = 0; which < N; ++which) {
    Pack<N> a = 7;
    Mask<N> m;
    set_lane(a, which, -2.5);
    set_lane(m, which, true);
    for (int l = 0; l < N; ++l) {
      EXPECT_EQ(lane(a, l), l == which ? -2.5 : 7);
      EXPECT_EQ(lane(m, l), l == which);
      EXPECT_EQ(lane(Pack<N>::of_bits(a.bits()), l), lane(a, l));
    }
    EXPECT_EQ(all(m), N == 1);
    EXPECT_TRUE(any(m));
  }
  EXPECT_FALSE(any(Mask<N>()));
  EXPECT_TRUE(all(Mask<N>(true)));
}

TYPED_TEST(PackOf, NumbersGoesIntoMatrices) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(2);
  const auto draw = [&] { return std::uniform_real_distribution<double>(-2, 2)(random); };
  using Matrix = Eigen::Matrix<Pack<N>, 3, 3>;
  using Vector = Eigen::Matrix<Pack<N>, 3, 1>;
  Matrix A;
  Vector v;
  std::array<Eigen::Matrix3d, N> As;
  std::array<Eigen::Vector3d, N> vs;
  for (std::size_t l = 0; l < N; ++l) {
    As[l] = Eigen::Matrix3d::NullaryExpr(draw);
    vs[l] = Eigen::Vector3d::NullaryExpr(draw);
    for (int i = 0; i < 3; ++i) {
      set_lane(v(i), static_cast<int>(l), vs[l](i));
      for (int j = 0; j < 3; ++j) set_lane(A(i, j), static_cast<int>(l), As[l](i, j));
    }
  }
  const Vector product = A.transpose() * v * 0.5 + v.cross(Vector(A.col(0)));
  const Pack<N> square = v.squaredNorm();
  for (std::size_t l = 0; l < N; ++l) {
    const Eigen::Vector3d want =
        As[l].transpose() * vs[l] * 0.5 + vs[l].cross(Eigen::Vector3d(As[l].col(0)));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(lane(product(i), static_cast<int>(l)), want(i), 1e-14);
    EXPECT_NEAR(lane(square, static_cast<int>(l)), vs[l].squaredNorm(), 1e-14);
  }
}

}  // namespace
}  // namespace quadtune
