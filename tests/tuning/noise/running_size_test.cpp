// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/running_size.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

FilterRun run_of(const Eigen::RowVectorXd& innovation, double variance) {
  FilterRun run;
  run.status = LikelihoodStatus::computed;
  run.innovation = innovation;
  run.variance.setConstant(1, innovation.size(), variance);
  return run;
}

// Means of three, over the existing measurements.
TEST(RunningSize, IsTheMeanOverAWindow) {
  const double nan = std::nan("");
  const RunningSize size = normalized_innovation_window(
      run_of((Eigen::RowVectorXd(7) << 1, nan, 2, 3, nan, nan, 4).finished(), 2), 0, 3);
  for (const Index k : {0, 1, 4, 5, 6}) EXPECT_TRUE(std::isnan(size.value(k))) << k;
  EXPECT_NEAR(size.value(2), (1 + 4 + 9) / 6., 1e-15);
  EXPECT_NEAR(size.value(3), (4 + 9 + 16) / 6., 1e-15);
}

// χ² of 10 degrees: 3.2470 and 20.4832.
TEST(RunningSize, HasTheBandOfChiSquared) {
  const RunningSize size =
      normalized_innovation_window(run_of(Eigen::RowVectorXd::Zero(3), 1), 0, 10);
  EXPECT_NEAR(size.low, 0.32470, 1e-5);
  EXPECT_NEAR(size.high, 2.04832, 1e-5);
  EXPECT_TRUE(size.value.array().isNaN().all());
}

TEST(RunningSize, StaysInItsIntervalIfTheFilterIsRight) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1);
  Eigen::RowVectorXd z(100000);
  for (double& value : z) value = normal(random);
  const RunningSize size = normalized_innovation_window(run_of(z, 1), 0, 50);
  Index inside = 0, count = 0;
  for (const double value : size.value) {
    if (std::isnan(value)) continue;
    ++count;
    if (value > size.low && value < size.high) ++inside;
  }
  EXPECT_EQ(count, 100000 - 49);
  EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(count), 0.95, 0.01);
}

TEST(RunningSize, RejectsNumbersOutOfRange) {
  const FilterRun run = run_of(Eigen::RowVectorXd::Zero(3), 1);
  EXPECT_THAT([&] { (void)normalized_innovation_window(run, 1, 3); },
              ThrowsMessage<InvalidInput>(HasSubstr("output 1 of 1")));
  EXPECT_THAT([&] { (void)normalized_innovation_window(run, 0, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("a window of 0")));
}

}  // namespace
}  // namespace quadtune
