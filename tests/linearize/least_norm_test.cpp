// SPDX-License-Identifier: Apache-2.0
#include "least_norm.hpp"

#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"

namespace quadtune::internal {
namespace {

using testing::MatrixNear;

TEST(LeastNorm, SharesASumEqually) {
  const Eigen::MatrixXd C = Eigen::MatrixXd::Ones(1, 4);
  const Eigen::VectorXd d = Eigen::VectorXd::Constant(1, 2.0);
  EXPECT_THAT(least_norm(C, d), MatrixNear(Eigen::VectorXd::Constant(4, 0.5), 1e-15));
}

TEST(LeastNorm, GivesTheRestToThoseBelowTheirBound) {
  const Eigen::MatrixXd C = Eigen::MatrixXd::Ones(1, 4);
  const Eigen::VectorXd d = Eigen::VectorXd::Constant(1, 2.0);
  Eigen::VectorXd low = Eigen::VectorXd::Zero(4), high = Eigen::VectorXd::Ones(4);
  high(0) = 0.2;
  EXPECT_THAT(bounded_least_norm(C, d, low, high),
              MatrixNear(Eigen::Vector4d(0.2, 0.6, 0.6, 0.6), 1e-14));
}

// The projections alone converge to the bound (0, 1, 1) only slowly; the entries that are free, the
// first among them, are solved for: of f0 + f1/2 + f2/3 = 1 with f2 ≤ 0.1, the shortest is
// (1, 1/2) (1 - 0.1/3) / (1 + 1/4).
TEST(LeastNorm, SolvesAllFreeEntriesToRounding) {
  Eigen::MatrixXd C(1, 3);
  C << 1, 1.0 / 2, 1.0 / 3;
  const Eigen::VectorXd d = Eigen::VectorXd::Ones(1);
  const Eigen::VectorXd low = Eigen::VectorXd::Zero(3);
  const Eigen::Vector3d high(1, 1, 0.1);
  const double share = (1 - 0.1 / 3) / 1.25;
  EXPECT_THAT(bounded_least_norm(C, d, low, high),
              MatrixNear(Eigen::Vector3d(share, share / 2, 0.1), 1e-15));
}

// Optimality of the least norm among feasible points: f·(y - f) ≥ 0 for feasible y.
TEST(LeastNorm, NoOtherSharingWithinTheBoundsIsShorter) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto draw = [&](Eigen::Index rows, Eigen::Index cols) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return unit(random); });
  };
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::MatrixXd C = draw(3, 8).array() - 0.5;
    const Eigen::VectorXd low = Eigen::VectorXd::Constant(8, 0.1);
    const Eigen::VectorXd high = Eigen::VectorXd::Ones(8);
    const Eigen::VectorXd y = 0.1 + 0.9 * draw(8, 1).array();
    const Eigen::VectorXd f = bounded_least_norm(C, C * y, low, high);
    EXPECT_THAT(C * f, MatrixNear(C * y, 1e-9));
    EXPECT_GE(f.minCoeff(), 0.1);
    EXPECT_LE(f.maxCoeff(), 1);
    EXPECT_GE(f.dot(y - f), -1e-7);
  }
}

TEST(LeastNorm, LeavesAResidualWhereNothingFits) {
  const Eigen::MatrixXd C = Eigen::MatrixXd::Ones(1, 2);
  const Eigen::VectorXd d = Eigen::VectorXd::Constant(1, 5.0);
  const Eigen::VectorXd f =
      bounded_least_norm(C, d, Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2));
  EXPECT_THAT(f, MatrixNear(Eigen::Vector2d(1, 1), 0));
}

}  // namespace
}  // namespace quadtune::internal
