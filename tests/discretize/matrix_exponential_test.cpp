// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matrix_exponential.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "matrix_near.hpp"
#include "plants/extended_hold.hpp"
#include "plants/slicot_example.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

MatrixXd exponential(const MatrixXd& A) {
  const ExponentialResult result = matrix_exponential(A);
  EXPECT_TRUE(result.solved());
  return result.E;
}

MatrixXd gaussian(Eigen::Index n, double norm, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  MatrixXd A = MatrixXd::NullaryExpr(n, n, [&] { return normal(generator); });
  return A * (norm / A.cwiseAbs().rowwise().sum().maxCoeff());
}

TEST(MatrixExponential, IsTheExponentialOfANumber) {
  for (const double a : {0.0, 1e-300, 1e-9, 0.003, 0.08, 0.3, 1.0, 1.2, -1.0, -30.0, 30.0, -700.0,
                         700.0, -1e5, -1e308})
    EXPECT_NEAR(exponential(MatrixXd::Constant(1, 1, a))(0, 0), std::exp(a),
                4e-16 * std::max(1.0, std::abs(a)) * std::exp(a))
        << a;
}

TEST(MatrixExponential, RotatesByTheAngle) {
  for (const double angle : {1e-6, 0.1, 1.0, 3.0, 100.0}) {
    const MatrixXd A{{0, -angle}, {angle, 0}};
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    EXPECT_THAT(exponential(A), MatrixNear(MatrixXd{{c, -s}, {s, c}}, 4e-16 * (1 + angle)))
        << angle;
  }
}

// The series of a nilpotent matrix is finite for any entries: no scaling is needed.
TEST(MatrixExponential, IsExactForNilpotentMatrices) {
  const MatrixXd A{{0, 1e200, 0}, {0, 0, 1e-100}, {0, 0, 0}};
  EXPECT_THAT(exponential(A), MatrixNear(MatrixXd{{1, 1e200, 5e99}, {0, 1, 1e-100}, {0, 0, 1}}, 0));
  MatrixXd chain = MatrixXd::Zero(4, 4);
  chain.diagonal(1).setConstant(0.5);
  const MatrixXd expected{
      {1, 0.5, 0.125, 1.0 / 48}, {0, 1, 0.5, 0.125}, {0, 0, 1, 0.5}, {0, 0, 0, 1}};
  EXPECT_THAT(exponential(chain), MatrixNear(expected, 1e-17));
}

// Slow modes next to fast ones: squaring e^(Ah) instead of e^(Ah) - I would lose 2¹⁷ ulp here.
TEST(MatrixExponential, KeepsTheDigitsOfASlowModeNextToAFastOne) {
  const MatrixXd A{{-1e5, 0}, {0, -1e-3}};
  EXPECT_NEAR(exponential(A)(1, 1), std::exp(-1e-3), 3e-16);
}

TEST(MatrixExponential, AgreesWithExtendedPrecisionForAllSizesAndNorms) {
  std::mt19937_64 generator(7);
  for (Eigen::Index n = 1; n <= 30; ++n)
    for (const double norm : {1e-8, 1e-3, 0.05, 0.2, 0.6, 1.5, 8.0, 60.0}) {
      const MatrixXd A = gaussian(n, norm, generator);
      const MatrixXd reference = testing::extended_hold(A, A, 1).E;
      EXPECT_THAT(exponential(A), MatrixRelativelyNear(reference, 4e-16 * std::max(1.0, 2 * norm)))
          << "n " << n << " norm " << norm;
    }
}

TEST(MatrixExponential, TimesThatOfTheNegativeIsTheIdentity) {
  std::mt19937_64 generator(11);
  for (const Eigen::Index n : {3, 12, 17, 40}) {
    const MatrixXd A = gaussian(n, 2, generator);
    EXPECT_THAT(exponential(A) * exponential(-A), MatrixNear(MatrixXd::Identity(n, n), 1e-14));
  }
}

TEST(MatrixExponential, ReproducesSlicotExamples) {
  QUADTUNE_REQUIRE_DATA(data);
  const std::filesystem::path folder = data / "known" / "slicot";
  struct Example {
    const char* name;
    Eigen::Index n;
    const char* after;  // the line of parameters: n, delta, …
    double delta;
  };
  for (const Example& e :
       {Example{"MB05ND", 5, "   5     0.1", 0.1}, Example{"MB05MD", 4, "   4     1.0", 1.0},
        Example{"MB05OD", 3, "   3     1.0", 1.0}}) {
    const std::string name = e.name;
    const MatrixXd A = testing::matrix_after(folder / (name + ".dat"), e.after, e.n, e.n);
    const MatrixXd printed =
        testing::matrix_after(folder / (name + ".res"), "exp(A*DELTA) is", e.n, e.n);
    EXPECT_THAT(exponential(A * e.delta), MatrixNear(printed, 0.51e-4)) << name;
  }
}

TEST(MatrixExponential, ReportsOverflowInsteadOfInfinity) {
  for (const double a : {710.0, 1e5, 1e308}) {
    const ExponentialResult result = matrix_exponential(MatrixXd{{a, 0}, {1, -1}});
    EXPECT_EQ(result.status, ExponentialStatus::overflow) << a;
    EXPECT_TRUE(result.E.array().isNaN().all()) << a;
  }
}

TEST(MatrixExponential, WorkspaceMayBeUsedAgainAndInPlace) {
  std::mt19937_64 generator(3);
  MatrixExponential workspace(6);
  for (const double norm : {20.0, 0.01, 900.0, 1.0}) {  // 900 decays or overflows; 1 is clean again
    MatrixXd A = gaussian(6, norm, generator);
    const ExponentialResult fresh = matrix_exponential(A);
    const ExponentialStatus status = workspace.solve(A, A);
    ASSERT_EQ(status, fresh.status);
    if (fresh.solved()) {
      EXPECT_THAT(A, MatrixNear(fresh.E, 0));
    }
  }
}

TEST(MatrixExponential, RefusesWhatIsNotASquareOfFiniteNumbers) {
  EXPECT_THAT([] { (void)matrix_exponential(MatrixXd::Zero(2, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("A is 2x3, expected 2x2 (A must be square)")));
  EXPECT_THAT([] { (void)matrix_exponential(MatrixXd()); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected at least 1 row")));
  MatrixXd A = MatrixXd::Zero(2, 2);
  A(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { (void)matrix_exponential(A); },
              ThrowsMessage<InvalidInput>(HasSubstr("A has nan at (2,1), expected finite")));
  MatrixExponential workspace(3);
  EXPECT_THAT([&] { (void)workspace.solve(A, A); },
              ThrowsMessage<InvalidInput>(HasSubstr("A is 2x2, expected 3x3")));
}

}  // namespace
}  // namespace quadtune
