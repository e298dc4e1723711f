// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/lyapunov.hpp"

#include <fstream>

#include "matrix_near.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

TEST(Lyapunov, ScalarsInClosedForm) {
  const MatrixXd a = MatrixXd::Constant(1, 1, -0.25);
  const MatrixXd q = MatrixXd::Constant(1, 1, 3);
  EXPECT_THAT(lyapunov_continuous(a, q).X, MatrixNear(MatrixXd::Constant(1, 1, 6.0), 1e-15));
  EXPECT_THAT(lyapunov_discrete(a, q).X, MatrixNear(MatrixXd::Constant(1, 1, 3.2), 1e-15));
}

// Stationary covariance of ẍ + 2 ζ ω ẋ + ω² x = w, unit intensity: diag(1/(4 ζ ω³), 1/(4 ζ ω)).
TEST(Lyapunov, DrivenOscillator) {
  const double zeta = 0.1;
  const double omega = 3;
  const MatrixXd A = (MatrixXd(2, 2) << 0, 1, -omega * omega, -2 * zeta * omega).finished();
  const MatrixXd Q = Eigen::Vector2d(0, 1).asDiagonal();
  const LyapunovResult r = lyapunov_continuous(A, Q);
  ASSERT_TRUE(r.solved());
  const MatrixXd expected =
      Eigen::Vector2d(1 / (4 * zeta * omega * omega * omega), 1 / (4 * zeta * omega)).asDiagonal();
  EXPECT_THAT(r.X, MatrixNear(expected, 1e-14));
}

// SLICOT's SB03MD example: Aᵀ X A - X = C with unstable A; ours is A X Aᵀ - X + Q = 0.
TEST(Lyapunov, ExampleOfTheSlicotManual) {
  QUADTUNE_REQUIRE_DATA(data);
  std::vector<double> numbers = testing::fortran_numbers(data / "known" / "slicot" / "SB03MD.dat");
  numbers.erase(numbers.begin());  // the order
  // The "D" of the title line is not a number, so that parsing continues with the matrices.
  const MatrixXd A = testing::take_matrix(numbers, 3, 3);
  const MatrixXd C = testing::take_matrix(numbers, 3, 3);
  const LyapunovResult r = lyapunov_discrete(A.transpose(), -C);
  ASSERT_TRUE(r.solved());
  EXPECT_THAT(r.X, MatrixNear((MatrixXd(3, 3) << 2, 1, 1, 1, 3, 0, 1, 0, 4).finished(), 1e-13));
}

TEST(Lyapunov, RandomEquations) {
  std::mt19937_64 random(4);
  for (const Eigen::Index n : {1, 2, 3, 8, 17, 40}) {
    const MatrixXd A = testing::random_matrix(n, n, random);
    const MatrixXd M = testing::random_matrix(n, n, random);
    const MatrixXd Q = M + M.transpose();  // indefinite, and A unstable: both are allowed
    const LyapunovResult c = lyapunov_continuous(A, Q);
    ASSERT_TRUE(c.solved()) << c.culprit;
    EXPECT_EQ(c.X, c.X.transpose());
    EXPECT_LE(c.residual, 1e-13);
    EXPECT_LE((A * c.X + c.X * A.transpose() + Q).norm(), 1e-12 * (A * c.X).norm());
    const LyapunovResult d = lyapunov_discrete(A, Q);
    ASSERT_TRUE(d.solved()) << d.culprit;
    EXPECT_LE(d.residual, 1e-13);
    EXPECT_LE((A * d.X * A.transpose() - d.X + Q).norm(), 1e-12 * (A * d.X * A.transpose()).norm());
  }
}

// In other units of a state, the equation has the same solution in these units.
TEST(Lyapunov, DoesNotDependOnTheUnitsOfTheStates) {
  const MatrixXd slow = (MatrixXd(2, 2) << -1, 1, 0, -2).finished();
  const MatrixXd sampled = (MatrixXd(2, 2) << 0.9998, 1, 0, 0.9998).finished();
  const MatrixXd Q = (MatrixXd(2, 2) << 0, 0, 0, 1).finished();
  for (const double unit : {1e-8, 1e-3, 1e2, 1e8}) {
    const MatrixXd D = Eigen::Vector2d(unit, 1).asDiagonal();
    const MatrixXd inverse = D.inverse();
    const LyapunovResult continuous = lyapunov_continuous(D * slow * inverse, D * Q * D);
    ASSERT_EQ(continuous.status, LyapunovStatus::solved) << unit << continuous.culprit;
    EXPECT_THAT(inverse * continuous.X * inverse, MatrixNear(lyapunov_continuous(slow, Q).X, 1e-12))
        << unit;
    const LyapunovResult discrete = lyapunov_discrete(D * sampled * inverse, D * Q * D);
    ASSERT_EQ(discrete.status, LyapunovStatus::solved) << unit << discrete.culprit;
    const MatrixXd expected = lyapunov_discrete(sampled, Q).X;
    EXPECT_THAT(inverse * discrete.X * inverse / expected.norm(),
                MatrixNear(expected / expected.norm(), 1e-9))
        << unit;
  }
}

TEST(Lyapunov, NamesThePairThatMakesItSingular) {
  const MatrixXd Q = MatrixXd::Identity(2, 2);
  const LyapunovResult mirrored =
      lyapunov_continuous(Eigen::Vector2d(-2, 2).asDiagonal().toDenseMatrix(), Q);
  EXPECT_EQ(mirrored.status, LyapunovStatus::singular);
  EXPECT_EQ(mirrored.culprit, "eigenvalues -2 and 2 of A add to 0");
  EXPECT_TRUE(mirrored.X.array().isNaN().all());
  const MatrixXd rotation = (MatrixXd(2, 2) << 0, 1, -1, 0).finished();
  EXPECT_EQ(lyapunov_discrete(rotation, Q).culprit, "eigenvalues 1i and -1i of A multiply to 1");
  const MatrixXd chain = (MatrixXd(2, 2) << 0, 1, 0, 0).finished();
  EXPECT_EQ(lyapunov_continuous(chain, Q).culprit, "eigenvalues 0 and 0 of A add to 0");
}

TEST(Lyapunov, RefusesWrongInput) {
  const MatrixXd I = MatrixXd::Identity(2, 2);
  const MatrixXd skew = (MatrixXd(2, 2) << 1, 2, 0, 1).finished();
  EXPECT_THAT([&] { (void)lyapunov_continuous(MatrixXd(2, 3), I); },
              ThrowsMessage<InvalidInput>(HasSubstr("lyapunov_continuous: A is 2x3")));
  EXPECT_THAT([&] { (void)lyapunov_discrete(I, MatrixXd::Identity(3, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("lyapunov_discrete: Q is 3x3, expected 2x2")));
  EXPECT_THAT([&] { (void)lyapunov_discrete(I, skew); },
              ThrowsMessage<InvalidInput>(HasSubstr("Q is not symmetric")));
  EXPECT_THAT([&] { (void)lyapunov_discrete(I / 0.0, I); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected finite numbers")));
}

}  // namespace
}  // namespace quadtune
