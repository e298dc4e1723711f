// SPDX-License-Identifier: Apache-2.0
#include "noise/likelihood/steady_information.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <random>

#include "matrix_near.hpp"

namespace quadtune::internal {
namespace {

using Eigen::MatrixXd;
using testing::MatrixNear;

constexpr int kSize = 8;

Square<kSize> square_of(const MatrixXd& M) {
  Square<kSize> S;
  Eigen::Map<MatrixXd>(S.at, kSize, kSize) = M;
  return S;
}
MatrixXd matrix_of(const Square<kSize>& S) {
  return Eigen::Map<const MatrixXd>(S.at, kSize, kSize);
}

MatrixXd random_matrix(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(kSize, kSize, [&] { return normal(random); });
}

// Doubling agrees with single steps, whatever the number of steps, the start and how fast its
// effect decays.
TEST(SteadyInformation, IsTheSumOfItsSteps) {
  std::mt19937_64 random(4);
  for (const double radius : {0.2, 0.9, 0.999, 1.0})
    for (const bool from_nothing : {true, false}) {
      MatrixXd A = random_matrix(random);
      A *= radius / A.eigenvalues().cwiseAbs().maxCoeff();
      MatrixXd factor = random_matrix(random);
      factor.rightCols(kSize / 2).setZero();  // some directions gain no information in a step
      const MatrixXd W = factor * factor.transpose();
      factor = random_matrix(random);
      const MatrixXd start =
          from_nothing ? MatrixXd::Zero(kSize, kSize) : MatrixXd(100 * factor * factor.transpose());
      MatrixXd N = start, sum = MatrixXd::Zero(kSize, kSize);
      std::int64_t done = 0;
      for (const std::int64_t steps : {1, 2, 3, 7, 8, 31, 64, 100, 1023, 4096, 20011}) {
        for (; done < steps; ++done) {
          sum += N;
          N = (A * N * A.transpose() + W).eval();
        }
        const SteadyInformation<kSize> found =
            steady_information<kSize>(square_of(A), square_of(W), square_of(start), steps);
        EXPECT_THAT(matrix_of(found.last), MatrixNear(N, 1e-11 * N.norm())) << steps;
        EXPECT_THAT(matrix_of(found.sum), MatrixNear(sum, 1e-11 * sum.norm())) << steps;
      }
    }
}

}  // namespace
}  // namespace quadtune::internal
