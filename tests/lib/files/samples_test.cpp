// SPDX-License-Identifier: Apache-2.0
#include "quadtune/samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <numeric>
#include <random>

#include "data_memory.hpp"
#include "matrix_near.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using testing::data_memory;

constexpr std::size_t kMany = 8 << 20;  // numbers, 64 MiB
constexpr long kBytes = static_cast<long>(kMany * sizeof(double));

TEST(Samples, AreOfAFileWhereTheyAreLong) {
  const long before = data_memory();
  Samples samples(kMany, 1.5);
  EXPECT_LT(data_memory() - before, kBytes / 8);
  for (std::size_t i = 0; i < 3; ++i) samples.push_back(static_cast<double>(i));
  EXPECT_EQ(samples.size(), kMany + 3);
  EXPECT_EQ(samples[kMany - 1], 1.5);
  EXPECT_EQ(samples.back(), 2);
  const Samples copy = samples;
  EXPECT_EQ(copy, samples);
  EXPECT_LT(data_memory() - before, kBytes / 8);
}

TEST(Samples, AreOfTheHeapWhereNoFileCanBeHad) {
  EXPECT_EXIT(
      {
        setenv("TMPDIR", "/nowhere/at/all", 1);
        const long before = data_memory();
        const Samples samples(kMany, 1.5);
        const bool heap = data_memory() - before >= kBytes;
        std::exit(heap && samples.back() == 1.5 ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(Samples, OutliveALimitOfFiles) {
  EXPECT_EXIT(
      {
        rlimit limit{};
        limit.rlim_cur = limit.rlim_max = 4096;
        setrlimit(RLIMIT_FSIZE, &limit);
        const Samples samples(kMany, 1.5);
        // At an ordinary exit a build for coverage would write its counts, beyond the limit.
        std::_Exit(samples.back() == 1.5 ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(SampleMatrix, IsAMatrixOfEigen) {
  std::mt19937_64 random(1);
  const MatrixXd numbers = testing::uniform_matrix(3, 5, random);
  SampleMatrix a = numbers;
  EXPECT_THAT(MatrixXd(a), testing::MatrixNear(numbers, 0.0));
  a = (2 * a).rightCols(4);  // of itself
  EXPECT_THAT(MatrixXd(a), testing::MatrixNear(MatrixXd(2 * numbers.rightCols(4)), 0.0));
  SampleMatrix b = a, c(2, 2);
  EXPECT_NE(b.data(), a.data());
  b(0, 0) = 7;
  EXPECT_NE(a(0, 0), 7);
  c = std::move(b);
  EXPECT_EQ(c.rows(), 3);
  EXPECT_EQ(c(0, 0), 7);
  c = c;
  EXPECT_EQ(c(0, 0), 7);
  c.col(1).setZero();
  EXPECT_EQ(c.col(1).sum(), 0);
  c.resize(0, 0);
  EXPECT_EQ(c.size(), 0);
  c.setConstant(1, 2, 3);
  EXPECT_EQ(c.sum(), 6);
  Samples columns(6);
  std::iota(columns.begin(), columns.end(), 0.0);
  const SampleMatrix d(columns, 2, 3);
  EXPECT_EQ(d(1, 2), 5);
}

}  // namespace
}  // namespace quadtune
