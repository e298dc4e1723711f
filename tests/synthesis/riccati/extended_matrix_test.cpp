// SPDX-License-Identifier: Apache-2.0
#include "riccati/extended_matrix.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace quadtune::internal {
namespace {

ExtendedMatrix random_matrix(std::mt19937& random, Eigen::Index rows, Eigen::Index cols) {
  std::normal_distribution<double> normal;
  ExtendedMatrix M(rows, cols);
  for (Eigen::Index j = 0; j < cols; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) M(i, j) = Real(normal(random)) / 3;
  return M;
}

// 1/3 has no finite binary expansion, so an error in a digit beyond those of a double is seen.
TEST(ExtendedMatrix, SolvesLinearSystemsInFiftyDigits) {
  std::mt19937 random(1);
  for (Eigen::Index n = 1; n <= 12; ++n) {
    const ExtendedMatrix A = random_matrix(random, n, n), B = random_matrix(random, n, 3);
    const ExtendedLu lu(A);
    EXPECT_LT((A * lu.solve(B) - B).norm().convert_to<double>(), 1e-45) << n;
    EXPECT_LT((lu.inverse() * A - ExtendedMatrix::identity(n)).norm().convert_to<double>(), 1e-45)
        << n;
    ExtendedMatrix S = A * A.transpose();
    S.add_to_diagonal(1);
    const ExtendedCholesky cholesky(S);
    ASSERT_TRUE(cholesky.positive_definite()) << n;
    EXPECT_LT((S * cholesky.solve(B) - B).norm().convert_to<double>(), 1e-45) << n;
  }
}

TEST(ExtendedMatrix, PivotsWhereADiagonalEntryIsZero) {
  const ExtendedMatrix A(Eigen::Matrix3d{{0, 2, 0}, {0, 0, 4}, {8, 0, 0}});
  const ExtendedMatrix B(Eigen::Vector3d(2, 8, 24));
  EXPECT_EQ(ExtendedLu(A).solve(B).rounded(), Eigen::MatrixXd(Eigen::Vector3d(3, 1, 2)));
}

TEST(ExtendedMatrix, RejectsWhatIsSingularOrNotPositiveDefinite) {
  const Eigen::Matrix2d singular{{1, 2}, {2, 4}};
  EXPECT_FALSE(ExtendedLu(ExtendedMatrix(singular)).inverse().is_finite());
  EXPECT_FALSE(ExtendedCholesky(ExtendedMatrix(singular)).positive_definite());
  const Eigen::Matrix2d indefinite{{1, 2}, {2, 1}};
  EXPECT_FALSE(ExtendedCholesky(ExtendedMatrix(indefinite)).positive_definite());
  const Eigen::Matrix2d unknown{{std::numeric_limits<double>::quiet_NaN(), 0}, {0, 1}};
  EXPECT_FALSE(ExtendedCholesky(ExtendedMatrix(unknown)).positive_definite());
}

TEST(ExtendedMatrix, ComputesRealAndComplexEigenvalues) {
  // Companion matrix of (s - 3) (s² + 2 s + 5), whose roots are 3 and -1 ± 2i.
  const Eigen::Matrix3d M{{1, 1, 15}, {1, 0, 0}, {0, 1, 0}};
  Eigen::VectorXcd values = eigenvalues(ExtendedMatrix(M));
  ASSERT_EQ(values.size(), 3);
  std::sort(values.begin(), values.end(),
            [](const auto& a, const auto& b) { return std::imag(a) < std::imag(b); });
  EXPECT_LT(std::abs(values[0] - std::complex<double>(-1, -2)), 1e-15);
  EXPECT_LT(std::abs(values[1] - std::complex<double>(3, 0)), 1e-15);
  EXPECT_LT(std::abs(values[2] - std::complex<double>(-1, 2)), 1e-15);
}

}  // namespace
}  // namespace quadtune::internal
