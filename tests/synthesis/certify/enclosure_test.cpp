// SPDX-License-Identifier: Apache-2.0 An enclosure must contain the true value after every
// operation. The true value is computed with 64-bit mantissas.
#include "certify/enclosure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <random>

#include "certify/enclosed_hold.hpp"
#include "plants/extended_hold.hpp"

namespace quadtune::internal {
namespace {

using Eigen::MatrixXd;
using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

MatrixXd random_matrix(std::mt19937& random, Eigen::Index rows, Eigen::Index cols) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

bool holds(const Enclosure& enclosure, const Extended& M) {
  const Extended off = (M - enclosure.mid.cast<long double>()).cwiseAbs();
  return enclosure.rad.allFinite() &&
         (off.array() <= enclosure.rad.cast<long double>().array()).all();
}

TEST(Enclosure, ContainsSumsAndProducts) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const MatrixXd A = random_matrix(random, 5, 4);
    const MatrixXd B = random_matrix(random, 4, 3);
    const MatrixXd dA = 1e-3 * random_matrix(random, 5, 4).cwiseAbs();
    const MatrixXd dB = 1e-3 * random_matrix(random, 4, 3).cwiseAbs();
    const Enclosure a(A, dA);
    const Enclosure b(B, dB);
    // An extreme point with random signs.
    const MatrixXd sA = random_matrix(random, 5, 4).cwiseSign();
    const MatrixXd sB = random_matrix(random, 4, 3).cwiseSign();
    const Extended x = A.cast<long double>() + dA.cwiseProduct(sA).cast<long double>();
    const Extended y = B.cast<long double>() + dB.cwiseProduct(sB).cast<long double>();
    EXPECT_TRUE(holds(a * b, x * y));
    EXPECT_TRUE(holds(a + a, x + x));
    EXPECT_TRUE(holds(a - Enclosure(MatrixXd::Zero(5, 4)), x));
    EXPECT_TRUE(holds(NumberEnclosure::between(0.1, 0.3) * a, 0.2L * x));
    EXPECT_TRUE(holds(a / 3.0, x / 3.0L));
  }
}

// Only points: the radius then bounds rounding errors only.
TEST(Enclosure, BoundsTheRoundingOfProducts) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const MatrixXd A = random_matrix(random, 6, 6);
    const MatrixXd B = random_matrix(random, 6, 6);
    EXPECT_TRUE(holds(Enclosure(A) * Enclosure(B), A.cast<long double>() * B.cast<long double>()));
  }
}

TEST(EnclosedHold, ContainsTheExponentialAndItsIntegral) {
  std::mt19937 random(5);
  for (const double dt : {1e-3, 0.1, 1.0, 4.0}) {
    const MatrixXd A = random_matrix(random, 4, 4);
    const EnclosedHold hold = enclosed_hold(Enclosure(A), {dt, 0});
    const testing::ExtendedHold exact = testing::extended_hold(A, MatrixXd::Identity(4, 4), dt);
    // The reference is rounded to doubles: half a unit in the last place of its entries is allowed.
    const Enclosure slack(MatrixXd::Zero(4, 4), 0x1p-52 * exact.E.cwiseAbs());
    const Enclosure slack_integral(MatrixXd::Zero(4, 4), 0x1p-52 * exact.integral.cwiseAbs());
    EXPECT_TRUE(holds(hold.Phi + slack, exact.E.cast<long double>())) << dt;
    EXPECT_TRUE(holds(hold.Gamma + slack_integral, exact.integral.cast<long double>())) << dt;
    EXPECT_LT(hold.Phi.rad.maxCoeff(), 1e-10 * exact.E.cwiseAbs().maxCoeff()) << dt;
  }
}

// An interval of matrices: the enclosure contains the exponential of every member.
TEST(EnclosedHold, ContainsTheExponentialsOfAnInterval) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const MatrixXd A = random_matrix(random, 3, 3);
    const MatrixXd d = 0.05 * random_matrix(random, 3, 3).cwiseAbs();
    const EnclosedHold hold = enclosed_hold(Enclosure(A, d), {0.5, 0.1});
    const MatrixXd member = A + d.cwiseProduct(random_matrix(random, 3, 3).cwiseSign());
    for (const double t : {0.4, 0.5, 0.6}) {
      const testing::ExtendedHold exact =
          testing::extended_hold(member, MatrixXd::Identity(3, 3), t);
      EXPECT_TRUE(holds(hold.Phi, exact.E.cast<long double>()));
      EXPECT_TRUE(holds(hold.Gamma, exact.integral.cast<long double>()));
    }
  }
}

// Scalar: ∂²/∂s² e^((z + s w) t) = (w t)² e^(z t), so the bound is exact at the largest z.
TEST(EnclosedHold, BoundsTheCurvatureOfTheExponential) {
  const MatrixXd z = MatrixXd::Constant(1, 1, 1.5);
  const MatrixXd w = MatrixXd::Constant(1, 1, 2);
  const double exact = 4 * 0.25 * std::exp(0.75);
  const double bound = exponential_curvature(z, w, 0.5)(0, 0);
  EXPECT_GE(bound, exact);
  EXPECT_LE(bound, exact * (1 + 1e-9));
}

// Definiteness by less than rounding is not proved. Otherwise it is proved, and the bound is below
// the true value.
TEST(LeastEigenvalueBound, ProvesExactlyDefiniteMatrices) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 100; ++trial) {
    const MatrixXd V = random_matrix(random, 5, 5);
    const Eigen::HouseholderQR<MatrixXd> qr(V);
    const MatrixXd U = qr.householderQ();
    for (const double min : {1e-3, 1e-9, -1e-14, -1e-9}) {
      Eigen::VectorXd values(5);
      values << min, 0.5, 1, 2, 1;
      const MatrixXd S = U * values.asDiagonal() * U.transpose();
      const double bound = min_eigenvalue_bound(Enclosure(0.5 * (S + S.transpose())));
      if (min > 0) {
        EXPECT_GT(bound, 0.2 * min) << min;
        EXPECT_LE(bound, min + 1e-14);
      } else {
        EXPECT_LE(bound, 0) << min;
      }
    }
  }
}

TEST(LeastEigenvalueBound, SubtractsTheRadius) {
  const Enclosure S(MatrixXd::Identity(3, 3), MatrixXd::Constant(3, 3, 0.1));
  // Half of the eigenvalue 1, less the norm of the radius, 3 times 0.1.
  EXPECT_NEAR(min_eigenvalue_bound(S), 0.2, 1e-12);
  EXPECT_LE(min_eigenvalue_bound({MatrixXd::Identity(3, 3), MatrixXd::Constant(3, 3, 0.4)}), 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(min_eigenvalue_bound(Enclosure(MatrixXd::Constant(2, 2, nan))) > 0);
}

}  // namespace
}  // namespace quadtune::internal
