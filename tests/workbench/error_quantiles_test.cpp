// SPDX-License-Identifier: Apache-2.0
/// Values that an error exceeds in one of many flights, compared with closed forms and simulations.
#include "quadtune/workbench/flight/error_quantiles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

constexpr int kOutputs = 400;

std::vector<double> times(double duration) {
  std::vector<double> all;
  for (int k = 1; k <= kOutputs; ++k) all.push_back(duration * k / kOutputs);
  return all;
}

std::vector<std::size_t> starts(std::size_t count) {
  std::vector<std::size_t> all;
  for (std::size_t j = 0; j < count; ++j) all.push_back((2 * j + 1) * kOutputs / (2 * count));
  return all;
}

ErrorCovariance error_of(double duration, double (*covariance)(double s, double t)) {
  const std::vector<double> at = times(duration);
  ErrorCovariance error;
  error.starts = starts(16);
  error.variance.resize(kOutputs);
  error.covariance.setZero(16, kOutputs);
  for (std::size_t k = 0; k < kOutputs; ++k) {
    error.variance(static_cast<Eigen::Index>(k)) = covariance(at[k], at[k]);
    for (std::size_t j = 0; j < 16; ++j)
      if (k >= error.starts[j])
        error.covariance(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) =
            covariance(at[error.starts[j]], at[k]);
  }
  return error;
}

const std::vector<bool> kAll(kOutputs, true);

/// P(standard normal variable > u)
double tail(double u) { return std::erfc(u / std::sqrt(2.0)) / 2; }

TEST(RarelyExceeded, IsTheQuantileOfNormalAndRayleigh) {
  EXPECT_NEAR(2 * tail(rarely_exceeded({4}) / 2), 1e-3, 1e-9);
  EXPECT_NEAR(std::exp(-std::pow(rarely_exceeded({9, 9}) / 3, 2) / 2), 1e-3, 1e-9);
  EXPECT_NEAR(rarely_exceeded({4, 0}), rarely_exceeded({4}), 1e-9);
  EXPECT_EQ(rarely_exceeded({0, 0}), 0);
}

// W has E W²(t) = t: the mean over T is T/2 with variance T²/3, hence 1.5 degrees of freedom per
// axis. By the reflection principle P(max |W| > L) is at most, and nearly, 2 P(|W(T)| > L).
TEST(ErrorSize, OfARandomWalk) {
  const double T = 50;
  const ErrorCovariance walk = error_of(T, [](double s, double t) { return std::min(s, t); });
  const ErrorSize one = error_size({walk}, times(T), kAll);
  EXPECT_NEAR(one.rms, std::sqrt(T / 2), 0.01 * one.rms);
  EXPECT_NEAR(one.samples, 1.5, 0.1);
  EXPECT_NEAR(error_size({walk, walk}, times(T), kAll).samples, 3, 0.2);
  const double exceeded = 4 * tail(one.most_rarely / std::sqrt(T));
  EXPECT_GT(exceeded, 0.8e-3);
  EXPECT_LT(exceeded, 1.3e-3);
}

// A constant error exceeds a value immediately or never.
TEST(ErrorSize, OfAConstantError) {
  const ErrorCovariance constant = error_of(10, [](double, double) { return 0.25; });
  const ErrorSize size = error_size({constant}, times(10), kAll);
  EXPECT_NEAR(size.rms, 0.5, 1e-12);
  EXPECT_NEAR(size.samples, 1, 1e-9);
  EXPECT_NEAR(size.most_rarely, rarely_exceeded({0.25}), 1e-3 * size.most_rarely);
  EXPECT_NEAR(size.rms_rarely, rarely_exceeded({0.25}), 1e-3 * size.rms_rarely);
}

// 4000 simulated errors with the correlation e^(-|t|) on two axes: the predicted share exceeds it.
TEST(ErrorSize, OfAnErrorThatForgets) {
  const double T = 40, share = 0.05;
  const ErrorCovariance axis =
      error_of(T, [](double s, double t) { return std::exp(-std::abs(t - s)); });
  const ErrorSize size = error_size({axis, axis}, times(T), kAll, share);
  EXPECT_NEAR(size.samples, 2 * T, 0.15 * 2 * T);  // T²/∫∫ρ² = T/τ per axis
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  constexpr int kFlights = 4000, kFine = 4000;
  const double keep = std::exp(-T / kFine), add = std::sqrt(1 - keep * keep);
  int over_most = 0, over_rms = 0;
  for (int i = 0; i < kFlights; ++i) {
    double x = normal(random), y = normal(random), max = 0, sum = 0;
    for (int k = 0; k < kFine; ++k) {
      x = keep * x + add * normal(random);
      y = keep * y + add * normal(random);
      max = std::max(max, x * x + y * y);
      sum += (x * x + y * y) / kFine;
    }
    over_most += std::sqrt(max) > size.most_rarely;
    over_rms += std::sqrt(sum) > size.rms_rarely;
  }
  EXPECT_LT(over_most, 1.3 * share * kFlights);
  EXPECT_GT(over_most, 0.5 * share * kFlights);
  EXPECT_LT(over_rms, 1.3 * share * kFlights);
  EXPECT_GT(over_rms, 0.6 * share * kFlights);
}

TEST(ErrorSize, CountsOnlyWhatIsJudged) {
  const ErrorCovariance walk = error_of(10, [](double s, double t) { return std::min(s, t); });
  std::vector<bool> late(kOutputs, false);
  for (std::size_t k = kOutputs / 2; k < kOutputs; ++k) late[k] = true;
  EXPECT_NEAR(error_size({walk}, times(10), late).rms, std::sqrt(7.5), 0.02);
  const ErrorSize none = error_size({walk}, times(10), std::vector<bool>(kOutputs, false));
  EXPECT_EQ(none.rms, 0);
  EXPECT_EQ(none.most_rarely, 0);
}

TEST(ErrorSize, RefusesWhatDoesNotAgree) {
  const ErrorCovariance walk = error_of(10, [](double s, double t) { return std::min(s, t); });
  EXPECT_THROW((void)error_size({}, times(10), kAll), InvalidInput);
  EXPECT_THROW((void)error_size({walk}, {1, 2}, kAll), InvalidInput);
  EXPECT_THROW((void)error_size({walk}, times(10), kAll, 1), InvalidInput);
  ErrorCovariance other = walk;
  other.starts[0] += 1;
  EXPECT_THROW((void)error_size({walk, other}, times(10), kAll), InvalidInput);
}

}  // namespace
}  // namespace quadtune
