// SPDX-License-Identifier: Apache-2.0
/// Systems in series, and zeros of systems with several inputs and outputs.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <complex>
#include <random>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/synthesis/invariant_zeros.hpp"
#include "quadtune/synthesis/series.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using testing::random_plant;
using Complex = std::complex<double>;

TEST(Series, ResponseIsTheProductOfTheResponses) {
  std::mt19937_64 random(1);
  const ContinuousLti first = random_plant(3, 2, 4, true, random);
  const ContinuousLti second = random_plant(2, 4, 3, true, random);
  const FrequencyResponse both(series(first, second));
  for (const double w : {0.0, 0.3, 2.0, 40.0}) {
    const MatrixXcd expected = FrequencyResponse(second).at(w) * FrequencyResponse(first).at(w);
    EXPECT_LT((both.at(w) - expected).norm(), 1e-11 * expected.norm()) << w;
  }
  const MatrixXd gain = MatrixXd::Constant(1, 4, 2);
  EXPECT_LT(
      (FrequencyResponse(series(first, gain)).at(0.3) - gain * FrequencyResponse(first).at(0.3))
          .norm(),
      1e-12);
  const MatrixXd before = MatrixXd::Constant(2, 1, 3);
  EXPECT_LT(
      (FrequencyResponse(series(before, first)).at(0.3) - FrequencyResponse(first).at(0.3) * before)
          .norm(),
      1e-12);
}

TEST(Series, DifferentPeriodsAndSizesAreRejected) {
  std::mt19937_64 random(2);
  const ContinuousLti plant = random_plant(3, 2, 4, true, random);
  EXPECT_THROW((void)series(plant, plant), InvalidInput);
  const DiscreteLti slow{plant.A, plant.B, plant.C, plant.D, 0.1, {}, {}, {}};
  DiscreteLti fast{plant.A, MatrixXd::Ones(3, 4), plant.C, MatrixXd::Zero(4, 4), 0.01, {}, {}, {}};
  EXPECT_THROW((void)series(slow, fast), InvalidInput);
  fast.dt = 0.1;
  EXPECT_EQ(series(slow, fast).dt, 0.1);
}

TEST(InvariantZeros, OfAChannelAreTheRootsOfTheNumerator) {
  const ContinuousLti plant =
      realize(ContinuousTransferFunction{Eigen::Vector3d(1, 3, 2), Eigen::Vector4d(1, 4, 5, 6), 0});
  const InvariantZeros zeros = invariant_zeros(plant);
  ASSERT_EQ(zeros.zeros.size(), 2);
  EXPECT_NEAR(zeros.zeros.real().minCoeff(), -2, 1e-10);
  EXPECT_NEAR(zeros.zeros.real().maxCoeff(), -1, 1e-10);
  EXPECT_EQ(zeros.rank, 1);
}

TEST(InvariantZeros, ADoubleIntegratorHasNone) {
  ContinuousLti plant;
  plant.A = Eigen::Matrix2d{{0, 1}, {0, 0}};
  plant.B = Eigen::Vector2d(0, 1);
  plant.C = Eigen::RowVector2d(1, 0);
  EXPECT_EQ(invariant_zeros(plant).zeros.size(), 0);
}

/// diag(1/(s + 1), 1/(s + 2)) (1 2; 1 1) has no zero; 2 x 2 with 1/(s+1), 2/(s+3), 1/(s+1), 1/(s+1)
/// has the zero of its determinant: 1/(s+1)² - 2/((s+3)(s+1)) = (1 - s)/((s+1)²(s+3)), at 1.
TEST(InvariantZeros, ZeroInTheRightHalfPlaneThatNoChannelHas) {
  ContinuousLti plant;
  plant.A = Eigen::Vector3d(-1, -3, -1).asDiagonal();
  plant.B = MatrixXd{{1, 0}, {0, 1}, {0, 1}};
  plant.C = MatrixXd{{1, 2, 0}, {1, 0, 1}};
  const InvariantZeros zeros = invariant_zeros(plant);
  ASSERT_EQ(zeros.zeros.size(), 1);
  EXPECT_NEAR(zeros.zeros[0].real(), 1, 1e-10);
  EXPECT_NEAR(zeros.zeros[0].imag(), 0, 1e-10);
  EXPECT_EQ(zeros.rank, 2);
}

// With D of full rank, all zeros are finite and the system matrix loses rank at each.
TEST(InvariantZeros, SystemMatrixLosesRankAtEach) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Index n = 2 + trial % 5;
    const Index m = 1 + trial % 3;
    ContinuousLti plant = random_plant(n, m, m, trial % 2 == 0, random);
    const InvariantZeros zeros = invariant_zeros(plant);
    EXPECT_EQ(zeros.rank, std::min(n, m));
    for (const Complex& zero : zeros.zeros) {
      MatrixXcd pencil(n + m, n + m);
      pencil << plant.A.cast<Complex>() - zero * MatrixXcd::Identity(n, n), plant.B.cast<Complex>(),
          plant.C.cast<Complex>(), plant.D.cast<Complex>();
      const Eigen::VectorXd sigma = Eigen::JacobiSVD<MatrixXcd>(pencil).singularValues();
      EXPECT_LT(sigma[n + m - 1], 1e-8 * (sigma[0] + std::abs(zero))) << trial << " " << zero;
    }
  }
}

// A wide system has no zeros in general, except the modes that no input reaches.
TEST(InvariantZeros, UncontrollableModeOfANonsquareSystem) {
  ContinuousLti plant;
  plant.A = Eigen::Vector3d(-1, -2, -5).asDiagonal();
  plant.B = MatrixXd{{1, 0}, {0, 1}, {0, 0}};
  plant.C = Eigen::RowVector3d(1, 1, 1);
  plant.D = MatrixXd::Zero(1, 2);
  const InvariantZeros zeros = invariant_zeros(plant);
  ASSERT_EQ(zeros.zeros.size(), 1);
  EXPECT_NEAR(zeros.zeros[0].real(), -5, 1e-10);
}

}  // namespace
}  // namespace quadtune
