// SPDX-License-Identifier: Apache-2.0
#include "report/page/decimate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "numbers.hpp"

namespace quadtune {
namespace {

using report::decimate;
using report::Decimated;
using report::spread_rows;
using ::testing::ElementsAre;
using ::testing::SizeIs;

using testing::kInfinity;
using testing::kNaN;

std::vector<double> clock_of(std::size_t rows, double dt = 0.005) {
  std::vector<double> time;
  for (std::size_t i = 0; i < rows; ++i) time.push_back(dt * static_cast<double>(i));
  return time;
}

TEST(Decimate, LeavesShortRecordsAlone) {
  const std::vector<double> time = clock_of(10);
  const std::vector<double> values = {0, 1, kNaN, 3, kInfinity, 5, 6, 7, 8, 9};
  const Decimated kept = decimate(time, {&values}, 10);
  EXPECT_EQ(kept.time, time);
  ASSERT_THAT(kept.values, SizeIs(1));
  EXPECT_TRUE(std::isnan(kept.values[0][2]));
  EXPECT_EQ(kept.values[0][4], kInfinity);
  EXPECT_EQ(kept.values[0][9], 9);
}

TEST(Decimate, KeepsToItsRowsAndItsEnds) {
  for (const std::size_t rows : {5U, 6U, 7U, 100U, 3999U, 4000U})
    for (const std::size_t size : {4001U, 4002U, 5000U, 20001U, 100'000U}) {
      const std::vector<double> time = clock_of(size);
      const Decimated kept = decimate(time, {&time}, rows);
      ASSERT_LE(kept.time.size(), rows);
      EXPECT_GE(kept.time.size() + 1, rows);
      EXPECT_EQ(kept.time.front(), time.front());
      EXPECT_EQ(kept.time.back(), time.back());
      EXPECT_TRUE(std::ranges::adjacent_find(kept.time, std::greater_equal<>()) == kept.time.end());
      ASSERT_EQ(kept.values[0].size(), kept.time.size());
    }
}

TEST(Decimate, KeepsWhatIsSmooth) {
  const std::vector<double> time = clock_of(20'001);
  std::vector<double> ramp;
  ramp.reserve(time.size());
  for (const double t : time) ramp.push_back(3 * t - 1);
  const Decimated kept = decimate(time, {&ramp}, 4000);
  for (std::size_t i = 0; i < kept.time.size(); ++i)
    ASSERT_EQ(kept.values[0][i], 3 * kept.time[i] - 1);
}

// Property: a spike of one row, up or down, is found near its time wherever it is.
TEST(Decimate, KeepsEveryPeak) {
  std::mt19937 random(7);
  const std::vector<double> time = clock_of(20'001);
  const double bucket = 100.0 / 1999;
  for (int i = 0; i < 200; ++i) {
    std::vector<double> values;
    values.reserve(time.size());
    for (const double t : time) values.push_back(std::sin(t));
    const std::size_t at = random() % time.size();
    const double peak = i % 2 == 0 ? 5 : -5;
    values[at] = peak;
    const Decimated kept = decimate(time, {&values}, 4000);
    const auto found = std::ranges::find(kept.values[0], peak);
    ASSERT_NE(found, kept.values[0].end()) << "row " << at;
    EXPECT_NEAR(kept.time[static_cast<std::size_t>(found - kept.values[0].begin())], time[at],
                bucket);
  }
}

// Property: the extremes of any interval of noise are kept, up to the width of a bucket.
TEST(Decimate, KeepsTheEnvelopeOfNoise) {
  std::mt19937 random(8);
  std::normal_distribution<double> noise;
  const std::vector<double> time = clock_of(30'000);
  std::vector<double> values;
  for (std::size_t i = 0; i < time.size(); ++i) values.push_back(noise(random));
  const Decimated kept = decimate(time, {&values}, 1000);
  const double bucket = time.back() / 499 * 1.1;
  for (int window = 0; window < 38; ++window) {
    const double start = 1 + 3.7 * window;
    const auto range = [&](const std::vector<double>& t, const std::vector<double>& v,
                           double more) {
      double low = kInfinity, high = -kInfinity;
      for (std::size_t i = 0; i < t.size(); ++i)
        if (t[i] >= start - more && t[i] <= start + 2 + more) {
          low = std::min(low, v[i]);
          high = std::max(high, v[i]);
        }
      return std::pair(low, high);
    };
    const auto [low, high] = range(time, values, 0);
    const auto [kept_low, kept_high] = range(kept.time, kept.values[0], bucket);
    EXPECT_LE(kept_low, low);
    EXPECT_GE(kept_high, high);
  }
}

TEST(Decimate, KeepsGapsAndSparseValues) {
  const std::vector<double> time = clock_of(20'001);
  std::vector<double> gap(time.size(), 1), sparse(time.size(), kNaN), none(time.size(), kNaN);
  for (std::size_t i = 5000; i < 9000; ++i) gap[i] = std::array{kNaN, kInfinity}[i % 2];
  std::size_t count = 0;
  for (std::size_t i = 0; i < sparse.size(); i += 40, ++count) sparse[i] = static_cast<double>(i);
  const Decimated kept = decimate(time, {&gap, &sparse, &none}, 4000);
  for (std::size_t i = 0; i < kept.time.size(); ++i) {
    if (kept.time[i] > 25.06 && kept.time[i] < 44.94) {
      EXPECT_TRUE(std::isnan(kept.values[0][i])) << kept.time[i];
    } else if (kept.time[i] < 24.9 || kept.time[i] > 45.1) {
      EXPECT_EQ(kept.values[0][i], 1) << kept.time[i];
    }
    EXPECT_TRUE(std::isnan(kept.values[2][i]));
  }
  // All values of the slow sensor.
  std::size_t found = 0;
  for (const double value : kept.values[1]) found += std::isnan(value) ? 0 : 1;
  EXPECT_EQ(found, count);
}

TEST(SpreadRows, TakesFirstAndLastAndBetween) {
  EXPECT_THAT(spread_rows(0, 3), ElementsAre());
  EXPECT_THAT(spread_rows(1, 3), ElementsAre(0));
  EXPECT_THAT(spread_rows(3, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(spread_rows(9, 3), ElementsAre(0, 4, 8));
  EXPECT_THAT(spread_rows(100'001, 3000), SizeIs(3000));
  EXPECT_EQ(spread_rows(100'001, 3000).back(), 100'000U);
}

}  // namespace
}  // namespace quadtune
