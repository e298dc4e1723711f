// SPDX-License-Identifier: Apache-2.0
#include "margins/loop_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

namespace quadtune::internal {
namespace {

using Complex = std::complex<double>;

std::vector<double> values_on(const std::vector<double>& w, const FrequencyFunction& f) {
  std::vector<double> values;
  values.reserve(w.size());
  for (const double at : w) values.push_back(f(at));
  return values;
}

/// |Σ c_i (1/(jω - p_i) + 1/(jω - p_i*))|
struct Modes {
  Eigen::VectorXcd p;
  Eigen::VectorXcd c;

  Modes(int count, double least_damping, std::mt19937_64& random) : p(count), c(count) {
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < count; ++i) {
      const double w = std::pow(10, 3 * uniform(random));
      const double damping = std::pow(least_damping, uniform(random));
      p[i] = w * Complex(-damping, std::sqrt(1 - damping * damping));
      // Each mode alone has a peak of this magnitude.
      const double size = 0.5 + uniform(random);
      c[i] = std::polar(size * damping * w, 6.3 * uniform(random));
    }
  }
  [[nodiscard]] double at(double w) const {
    Complex sum = 0;
    for (Eigen::Index i = 0; i < p.size(); ++i)
      sum += c[i] / (Complex(0, w) - p[i]) + std::conj(c[i]) / (Complex(0, w) - std::conj(p[i]));
    return std::abs(sum);
  }
  /// The maximum between 0.1 and 1e4 on a grid many times as dense as each peak is narrow.
  [[nodiscard]] double dense_maximum() const {
    double largest = 0;
    for (int k = 0; k <= 20000; ++k) largest = std::max(largest, at(std::pow(10, -1 + k / 4000.0)));
    for (const Complex& root : p)
      for (int k = -2000; k <= 2000; ++k) {
        const double w = root.imag() + 0.005 * k * root.real();
        if (w > 0.1 && w < 1e4) largest = std::max(largest, at(w));
      }
    return largest;
  }
};

// Modes that are landmarks of the grid, down to a damping ratio of 1e-5.
TEST(LoopGrid, MissesNoPeakOfItsLandmarks) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 150; ++i) {
    const Modes modes(1 + i % 6, 1e-5, random);
    const auto f = [&](double w) { return modes.at(w); };
    const std::vector<double> w = loop_grid({.roots = {modes.p}});
    const Peak peak = highest_peak(f, w, values_on(w, f));
    EXPECT_GE(peak.value, modes.dense_maximum() * (1 - 1e-12)) << i;
    EXPECT_EQ(peak.value, f(peak.w));
  }
}

// Modes of a closed loop that are not landmarks of the plant's grid, as narrow as the grid step: a
// value on the flank of a peak predicts it.
TEST(LoopGrid, MissesNoPeakBetweenItsFrequencies) {
  std::mt19937_64 random(12);
  const std::vector<double> w = loop_grid({}, 0.1, 1e4);
  for (int i = 0; i < 300; ++i) {
    const Modes modes(1 + i % 6, 0.02, random);
    const auto f = [&](double at) { return modes.at(at); };
    const Peak peak = highest_peak(f, w, values_on(w, f));
    EXPECT_GE(peak.value, modes.dense_maximum() * (1 - 1e-12)) << i;
  }
}

// Only peaks that may be the largest are refined, whatever their size.
TEST(LoopGrid, RefinesFewPeaks) {
  const std::vector<double> w = loop_grid({}, 0.1, 1e7);
  for (const double size : {1e-3, 1.0, 1e3}) {
    int count = 0;
    const auto f = [&](double at) {
      ++count;
      double sum = 1 / std::hypot(1, 10 * std::log(at));
      for (const double other : {1e2, 1e3, 1e4, 1e5, 1e6})
        sum += 0.5 / std::hypot(1, 10 * std::log(at / other));
      return size * sum;
    };
    const std::vector<double> values = values_on(w, f);
    count = 0;
    EXPECT_GT(highest_peak(f, w, values).value, size);
    EXPECT_LE(count, 25) << size;
  }
}

TEST(LoopGrid, ReturnsTheSlowestOfEqualPeaks) {
  const std::vector<double> w = loop_grid({.corners = {1}});
  // 1 up to rounding everywhere.
  const auto flat = [](double at) { return std::abs(std::polar(1.0, at)); };
  EXPECT_EQ(highest_peak(flat, w, values_on(w, flat)).w, 0);
  const auto twins = [](double at) {
    const double x = std::log(at) / std::log(10.0) * std::numbers::pi;
    return at > 0 ? 2 + std::cos(2 * x) * (at > 0.05 && at < 50 ? 1 : 0) : 1;
  };
  EXPECT_NEAR(highest_peak(twins, w, values_on(w, twins)).w, 0.1, 1e-8);
  // Rounding errors do not decide.
  for (const double rounding : {1 - 1e-13, 1 + 1e-13}) {
    const auto unequal = [&](double at) { return twins(at) * (at > 0.5 ? rounding : 1); };
    EXPECT_NEAR(highest_peak(unequal, w, values_on(w, unequal)).w, 0.1, 1e-8) << rounding;
  }
}

TEST(LoopGrid, BeginsAtRestAndEndsAtNyquist) {
  Eigen::VectorXcd roots(3);
  roots << Complex(0.9, 0.1), Complex(0.9, -0.1), Complex(-0.99, 0);
  const std::vector<double> w = loop_grid({.roots = {roots}, .dt = 0.01});
  EXPECT_EQ(w.front(), 0);
  EXPECT_EQ(w.back(), std::numbers::pi / 0.01);
  EXPECT_TRUE(std::is_sorted(w.begin(), w.end()));
  for (std::size_t i = 2; i < w.size(); ++i) EXPECT_LT(w[i], 1.04 * w[i - 1]);
}

TEST(LoopGrid, DelayChangesThePhaseLittlePerStep) {
  const std::vector<double> w = loop_grid({.corners = {1}, .delay = 2, .delay_phase = 50});
  for (std::size_t i = 1; i < w.size() && w[i] < 25; ++i) EXPECT_LE(w[i] - w[i - 1], 0.1 + 1e-12);
  EXPECT_EQ(w.back(), 1000);
}

// Poles near the largest number, where squares and multiples overflow.
TEST(LoopGrid, IsFiniteForRootsOfAnySize) {
  for (const double size : {1e-300, 1e-12, 1e155, 1e308}) {
    Eigen::VectorXcd roots(2);
    roots << Complex(-1, 0), Complex(-size, size);
    for (const double delay : {0.0, 1e-305}) {
      const std::vector<double> w = loop_grid({.roots = {roots}, .delay = delay});
      ASSERT_FALSE(w.empty());
      EXPECT_TRUE(std::all_of(w.begin(), w.end(), [](double at) { return std::isfinite(at); }));
      EXPECT_LT(w.size(), 100'000u);
    }
  }
}

// NaN values have no order on which sorting could rely.
TEST(LoopGrid, AcceptsInfiniteValuesAndNan) {
  const std::vector<double> w = loop_grid({}, 0.1, 1e3);
  std::mt19937_64 random(13);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 100; ++i) {
    std::vector<double> values;
    for (std::size_t k = 0; k < w.size(); ++k) {
      const auto kind = random() % 8;
      values.push_back(kind == 0   ? kInfinity
                       : kind == 1 ? std::numeric_limits<double>::quiet_NaN()
                                   : static_cast<double>(random() % 1000));
    }
    const Peak peak = highest_peak([](double) { return 1.0; }, w, values);
    EXPECT_EQ(peak.value, kInfinity);
  }
}

TEST(Crossings, AreRootsToRounding) {
  std::vector<double> w;
  for (int i = 0; i <= 100; ++i) w.push_back(0.1 * i);
  const auto f = [](double at) { return std::cos(at); };
  const std::vector<double> found = crossings(f, w, values_on(w, f));
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(found[k], (static_cast<double>(k) + 0.5) * std::numbers::pi, 1e-14);
}

// If rounding determines the sign of some values, there is a crossing only if the certain signs on
// both sides differ.
TEST(Crossings, IgnoreUncertainSigns) {
  const std::vector<double> w = {1, 2, 3, 4, 5, 6};
  const std::vector<double> values = {1, 1e-17, -1e-17, 1e-17, -1e-17, 1};
  const auto certain = [&](std::size_t i) { return std::abs(values[i]) > 1e-16; };
  const auto f = [](double) { return 1.0; };
  EXPECT_TRUE(crossings(f, w, values, certain).empty());
  const auto falling = [](double at) { return 3.5 - at; };
  const std::vector<double> other_side = {1, 1e-17, -1e-17, 1e-17, -1e-17, -1};
  const std::vector<double> found =
      crossings(falling, w, other_side, [&](std::size_t i) { return certain(i); });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0], 3.5, 1e-14);
  // From the first frequency on.
  EXPECT_TRUE(crossings(f, w, {-1e-17, 1e-17, -1e-17, 1, 1, 1}, [](std::size_t i) {
                return i > 2;
              }).empty());
}

}  // namespace
}  // namespace quadtune::internal
