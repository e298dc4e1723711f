// SPDX-License-Identifier: Apache-2.0
#include "noise/judge/small_samples.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "quadtune/internal/tails.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The probabilities that each test states for series of normal numbers are right within the
// sampling error, or conservative by less than orders of magnitude.
TEST(SmallSamples, HaveTheStatedProbabilities) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 20000;
  constexpr double kLevel = 0.01;
  for (const Index n : {12, 25, 60, 99}) {
    int correlated = 0, shaped = 0;
    const Index lags = std::min<Index>(20, (n - 1) / 2);
    VectorXd z(n), r(lags);
    for (int draw = 0; draw < kDraws; ++draw) {
      for (Index k = 0; k < n; ++k) z(k) = normal(random);
      z.array() -= z.mean();
      const double m2 = z.squaredNorm();
      for (Index lag = 1; lag <= lags; ++lag)
        r(lag - 1) = z.head(n - lag).dot(z.tail(n - lag)) / m2;
      const auto count = static_cast<double>(n);
      correlated += largest_correlation(r, n).p < kLevel;
      shaped += kurtosis_p(count * z.array().pow(4).sum() / (m2 * m2) - 3, n) < kLevel;
    }
    // 200 expected, with a standard deviation of 14.
    EXPECT_LT(correlated, 260) << n;
    EXPECT_GT(correlated, 100) << n;
    EXPECT_LT(shaped, 270) << n;
    EXPECT_GT(shaped, 140) << n;
  }
}

TEST(SmallSamples, NameTheLeastProbableCorrelation) {
  const LargestCorrelation found = largest_correlation(Eigen::Vector3d(0.1, -0.95, 0.2), 20);
  EXPECT_EQ(found.lag, 2);
  EXPECT_EQ(found.value, -0.95);
  EXPECT_LT(found.p, 1e-6);
  // The value beyond which a correlation at a lag of 1 is as improbable.
  const double edge = correlation_exceeded(0.005, 20);
  EXPECT_NEAR(largest_correlation(VectorXd::Constant(1, edge), 20).p, 0.01, 1e-9);
  EXPECT_EQ(largest_correlation(VectorXd::Constant(1, 1.0), 20).p, 0);
  EXPECT_EQ(largest_correlation(Eigen::Vector2d(0.9, 0.9), 5).p, 1);
}

TEST(Tails, AreThoseOfTheirDistributions) {
  EXPECT_NEAR(normal_above(1.959963984540054), 0.025, 1e-12);
  EXPECT_NEAR(normal_exceeded(0.025), 1.959963984540054, 1e-12);
  EXPECT_NEAR(student_above(2.0, 5), boost::math::cdf(complement(boost::math::students_t(5), 2.0)),
              1e-14);
  EXPECT_NEAR(student_exceeded(0.025, 10), 2.2281388519649385, 1e-10);
  EXPECT_NEAR(chi_squared_exceeded(0.05, 1), 3.841458820694124, 1e-10);
  EXPECT_NEAR(chi_squared_above(3.841458820694124, 1), 0.05, 1e-12);
  EXPECT_NEAR(chi_squared_below(3.841458820694124, 1), 0.95, 1e-12);
  EXPECT_NEAR(normal_below(1.959963984540054), 0.975, 1e-12);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(student_quantile(0.975, 10), 2.2281388519649385, 1e-10);
  EXPECT_NEAR(chi_squared_quantile(0.95, 1), 3.841458820694124, 1e-10);
}

// Invalid values from a log are reported, not thrown.
TEST(Tails, AcceptAnyNumber) {
  const double infinity = std::numeric_limits<double>::infinity(), none = std::nan("");
  for (const double degrees : {1.0, 3998.0, 1e7}) {
    EXPECT_EQ(chi_squared_above(infinity, degrees), 0);
    EXPECT_EQ(chi_squared_above(1e308, degrees), 0);
    EXPECT_EQ(chi_squared_below(1e300, degrees), 1);
    EXPECT_EQ(chi_squared_below(0, degrees), 0);
    EXPECT_EQ(chi_squared_below(-1e-30, degrees), 0);
    EXPECT_EQ(chi_squared_two_sided(0, degrees), 0);
    EXPECT_EQ(chi_squared_two_sided(infinity, degrees), 0);
    EXPECT_TRUE(std::isnan(chi_squared_above(none, degrees)));
    EXPECT_TRUE(std::isnan(chi_squared_two_sided(none, degrees)));
    EXPECT_NEAR(student_above(infinity, degrees), 0, 1e-90);
    EXPECT_TRUE(std::isnan(student_above(none, degrees)));
  }
  EXPECT_EQ(normal_above(infinity), 0);
  EXPECT_EQ(normal_above(-infinity), 1);
  EXPECT_TRUE(std::isnan(normal_above(none)));
}

}  // namespace
}  // namespace quadtune::internal
