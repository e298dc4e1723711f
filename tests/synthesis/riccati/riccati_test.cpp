// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/riccati.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "matrix_near.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using testing::RiccatiCase;
using ::testing::ThrowsMessage;

MatrixXd matrix(std::initializer_list<std::initializer_list<double>> rows) {
  return MatrixXd(rows);
}

RiccatiResult solve_case(const RiccatiCase& c, bool discrete, const RiccatiOptions& options = {}) {
  return discrete ? dare(c.A, c.B, c.Q, c.R, c.N, options) : care(c.A, c.B, c.Q, c.R, c.N, options);
}

RiccatiOptions named(std::vector<std::string> names) {
  RiccatiOptions options;
  options.state_names = std::move(names);
  return options;
}

// Abels and Benner 1999 (CAREX), example 1.1: a double closed-loop pole at -1.
TEST(Care, SolvesTheDoubleIntegrator) {
  const RiccatiResult r =
      care(matrix({{0, 1}, {0, 0}}), matrix({{0}, {1}}), matrix({{1, 0}, {0, 2}}), matrix({{1}}));
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_THAT(r.X, MatrixNear(matrix({{2, 1}, {1, 2}}), 1e-14));
  EXPECT_THAT(r.K, MatrixNear(matrix({{1, 2}}), 1e-14));
  ASSERT_EQ(r.poles.size(), 2);
  EXPECT_NEAR(std::abs(r.poles[0] + 1.0), 0, 1e-7);  // a double pole moves by √eps
  EXPECT_LE(r.residual, 1e-15);
  EXPECT_FALSE(r.used_schur);
  EXPECT_TRUE(r.culprit.empty());
  EXPECT_TRUE(r.warning.empty());
}

// Example 1.2: X = (1 + √2) [9 6; 6 4].
TEST(Care, SolvesCarexExample2) {
  const MatrixXd Q = matrix({{9, 6}, {6, 4}});
  const RiccatiResult r =
      care(matrix({{4, 3}, {-4.5, -3.5}}), matrix({{1}, {-1}}), Q, matrix({{1}}));
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_THAT(r.X, MatrixRelativelyNear((1 + std::numbers::sqrt2) * Q, 1e-13));
}

// 2 a x - b² x²/r + q = 0.
TEST(Care, SolvesScalarEquations) {
  for (const double a : {-3.0, -1e-8, 0.0, 0.5, 100.0})
    for (const double b : {1e-3, 1.0, 250.0})
      for (const double q : {1e-6, 1.0, 1e6}) {
        const RiccatiResult r = care(matrix({{a}}), matrix({{b}}), matrix({{q}}), matrix({{2}}));
        ASSERT_TRUE(r.solved()) << r;
        const double g = b * b / 2;
        const double root = std::sqrt(a * a + g * q);
        const double x = a > 0 ? (a + root) / g : q / (root - a);
        EXPECT_NEAR(r.X(0, 0) / x, 1, 1e-14) << a << " " << b << " " << q;
        EXPECT_NEAR(r.poles[0].real() / -root, 1, 1e-14);
      }
}

// x = a² x - a² b² x²/(r + b² x) + q.
TEST(Dare, SolvesScalarEquations) {
  for (const double a : {0.0, 0.3, -0.9, 1.0, 1.7})
    for (const double q : {1e-6, 1.0, 1e6}) {
      const RiccatiResult r = dare(matrix({{a}}), matrix({{1}}), matrix({{q}}), matrix({{2}}));
      ASSERT_TRUE(r.solved()) << r;
      const double p = 2 - a * a * 2 - q;  // x² + p x - 2 q = 0
      const double root = std::sqrt(p * p + 8 * q);
      const double x = p > 0 ? 4 * q / (p + root) : (root - p) / 2;
      EXPECT_NEAR(r.X(0, 0) / x, 1, 1e-13) << a << " " << q;
    }
}

// SLICOT's SB02ND example: R = 0, and X is the identity.
TEST(Dare, AcceptsSingularR) {
  const RiccatiResult r =
      dare(matrix({{2, -1}, {1, 0}}), matrix({{1}, {0}}), matrix({{0, 0}, {0, 1}}), matrix({{0}}));
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_THAT(r.X, MatrixNear(MatrixXd::Identity(2, 2), 1e-14));
  EXPECT_THAT(r.K, MatrixNear(matrix({{2, -1}}), 1e-14));
  EXPECT_TRUE(r.used_schur || r.used_extended) << r;
}

TEST(Dare, SolvesSingularA) {
  const RiccatiResult r =
      dare(matrix({{0, 1}, {0, 0}}), matrix({{0}, {1}}), MatrixXd::Identity(2, 2), matrix({{1}}));
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_THAT(r.X, MatrixNear(matrix({{1, 0}, {0, 2}}), 1e-14));
}

// A cross term is the same as feeding u = v - R⁻¹ Nᵀ x forward: X stays, K gains R⁻¹ Nᵀ.
TEST(Riccati, CrossTermEqualsShiftedPlant) {
  std::mt19937_64 random(11);
  for (const bool discrete : {false, true})
    for (const Eigen::Index n : {3, 9, 14, 27}) {
      const RiccatiCase c = testing::random_case(n, 3, discrete, true, random);
      const MatrixXd shift = c.R.llt().solve(c.N.transpose());
      RiccatiCase plain{c.A - c.B * shift, c.B, c.Q - c.N * shift, c.R};
      plain.Q = (0.5 * (plain.Q + plain.Q.transpose())).eval();
      const RiccatiResult with = solve_case(c, discrete);
      const RiccatiResult without = solve_case(plain, discrete);
      ASSERT_TRUE(with.solved()) << with;
      ASSERT_TRUE(without.solved()) << without;
      EXPECT_THAT(with.X, MatrixRelativelyNear(without.X, 1e-11));
      EXPECT_THAT(with.K, MatrixRelativelyNear(without.K + shift, 1e-11));
      EXPECT_LE(testing::riccati_residual(c, with.X, discrete), 1e-13);
    }
}

// The mode at 1 is not observable through Q, but it is not on the boundary: it is mirrored to -1.
// The smallest solution, to which doubling converges, would leave it unstable.
TEST(Care, MirrorsAnUnstableModeUnobservableThroughQ) {
  const RiccatiResult r = care(matrix({{1}}), matrix({{1}}), matrix({{0}}), matrix({{1}}));
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_NEAR(r.X(0, 0), 2, 1e-14);
  EXPECT_NEAR(r.poles[0].real(), -1, 1e-14);
  EXPECT_TRUE(r.used_schur);
}

TEST(Dare, MirrorsAnUnstableModeUnobservableThroughQ) {
  const RiccatiResult r =
      dare(matrix({{2, 0}, {0, 0.5}}), matrix({{1}, {1}}), matrix({{0, 0}, {0, 0}}), matrix({{1}}));
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_THAT(r.X, MatrixNear(matrix({{3, 0}, {0, 0}}), 1e-13));  // 4x - 4x²/(1+x) = x
  EXPECT_NEAR(r.poles.cwiseAbs().maxCoeff(), 0.5, 1e-13);
}

TEST(Riccati, NothingToDoIsSolvedByZero) {
  const MatrixXd zero = MatrixXd::Zero(2, 2);
  const MatrixXd b = matrix({{0}, {1}});
  const RiccatiResult c = care(matrix({{-1, 0}, {0, -2}}), b, zero, matrix({{1}}));
  ASSERT_TRUE(c.solved()) << c;
  EXPECT_THAT(c.X, MatrixNear(zero, 0.0));
  EXPECT_EQ(c.residual, 0);
  const RiccatiResult d = dare(zero, b, zero, matrix({{1}}));
  ASSERT_TRUE(d.solved()) << d;
  EXPECT_THAT(d.X, MatrixNear(zero, 0.0));
}

TEST(Care, NamesTheUncontrollableMode) {
  RiccatiCase c = testing::small_hover();
  c.B.row(9).setZero();  // no roll torque
  const RiccatiResult r = solve_case(c, false, named(testing::small_hover_names()));
  EXPECT_EQ(r.status, RiccatiStatus::not_stabilizable);
  EXPECT_EQ(r.culprit, "mode at 0: a combination of y, roll, vy and p cannot be controlled");
  EXPECT_TRUE(r.X.array().isNaN().all());
  EXPECT_TRUE(r.K.array().isNaN().all());
  EXPECT_EQ(r.poles.size(), 0);
}

TEST(Care, NamesADoubleIntegratorWithoutInput) {
  const MatrixXd A = matrix({{0, 1, 0}, {0, 0, 0}, {0, 0, -1}});
  const RiccatiResult r = care(A, matrix({{0}, {0}, {1}}), MatrixXd::Identity(3, 3), matrix({{1}}),
                               MatrixXd(), named({"y", "vy", "w"}));
  EXPECT_EQ(r.status, RiccatiStatus::not_stabilizable);
  EXPECT_EQ(r.culprit, "mode at 0: a combination of y and vy cannot be controlled");
}

// Two integrals of the same output: only one of them is controllable.
TEST(Care, NamesAnUncontrollableIntegral) {
  const MatrixXd A = matrix({{0, 1, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}});
  const RiccatiResult r = care(A, matrix({{0}, {1}, {0}, {0}}), MatrixXd::Identity(4, 4),
                               matrix({{1}}), MatrixXd(), named({"y", "vy", "int a", "int b"}));
  EXPECT_EQ(r.status, RiccatiStatus::not_stabilizable);
  EXPECT_EQ(r.culprit, "mode at 0: a combination of int a and int b cannot be controlled");
}

TEST(Care, NamesTheModeUnobservableThroughQ) {
  RiccatiCase c = testing::small_hover();
  c.Q(5, 5) = 0;
  const RiccatiResult r = solve_case(c, false, named(testing::small_hover_names()));
  EXPECT_EQ(r.status, RiccatiStatus::not_detectable);
  EXPECT_EQ(r.culprit, "mode at 0: yaw is not observable through Q");
}

TEST(Dare, NamesTheCulprits) {
  RiccatiCase unseen = testing::small_hover_sampled(0.01);
  unseen.Q(5, 5) = 0;
  const RiccatiOptions options = named(testing::small_hover_names());
  EXPECT_EQ(solve_case(unseen, true, options).culprit,
            "mode at z = 1: yaw is not observable through Q");
  RiccatiCase unsteered = testing::small_hover_sampled(0.01);
  unsteered.B.col(3).setZero();
  EXPECT_EQ(solve_case(unsteered, true, options).culprit,
            "mode at z = 1: a combination of yaw and r cannot be controlled");
}

TEST(Care, NamesOscillatingModes) {
  const RiccatiResult growing = care(matrix({{0.1, 2}, {-2, 0.1}}), matrix({{0}, {0}}),
                                     MatrixXd::Identity(2, 2), matrix({{1}}));
  EXPECT_EQ(growing.culprit,
            "mode at 0.1 ± 2i: a combination of state 1 and state 2 cannot be controlled");
  const RiccatiResult unseen =
      care(matrix({{0, 2}, {-2, 0}}), matrix({{0}, {1}}), MatrixXd::Zero(2, 2), matrix({{1}}));
  EXPECT_EQ(unseen.status, RiccatiStatus::not_detectable);
  EXPECT_EQ(unseen.culprit,
            "mode at ±2i: a combination of state 1 and state 2 is not observable through Q");
}

TEST(Care, NamesMeasurementsForAFilter) {
  RiccatiOptions options = named({"a", "b"});
  options.problem = RiccatiProblem::filter;
  const RiccatiResult r = care(MatrixXd::Zero(2, 2), matrix({{1}, {0}}), MatrixXd::Identity(2, 2),
                               matrix({{1}}), MatrixXd(), options);
  EXPECT_EQ(r.culprit, "mode at 0: b cannot be observed by the measurements");
}

// A change of states scatters the four zero eigenvalues of a chain over a circle of radius 1e-4.
TEST(Care, FindsTheCulpritInAnyBasis) {
  std::mt19937_64 random(5);
  for (int k = 0; k < 10; ++k) {
    RiccatiCase c = testing::small_hover();
    c.B.row(9).setZero();
    const MatrixXd T = testing::random_matrix(12, 12, random);
    c.A = T.partialPivLu().solve(c.A * T);
    c.B = T.partialPivLu().solve(c.B).eval();
    c.Q = T.transpose() * c.Q * T;
    c.Q = (0.5 * (c.Q + c.Q.transpose())).eval();
    const RiccatiResult r = solve_case(c, false);
    EXPECT_EQ(r.status, RiccatiStatus::not_stabilizable) << r;
    EXPECT_THAT(r.culprit, HasSubstr("mode at 0: "));
  }
}

// [Q N; Nᵀ R] indefinite: x' = u, cost u² + 2 x u·0.5 - x²/4 … has H with a double eigenvalue 0.
TEST(Care, ReportsAPairOnTheBoundary) {
  const RiccatiResult r = care(matrix({{0, 1}, {-1, 0}}), matrix({{0}, {1}}),
                               matrix({{-2, 0}, {0, -2}}), matrix({{1}}));
  EXPECT_EQ(r.status, RiccatiStatus::boundary_pair) << r;
  EXPECT_THAT(r.culprit, HasSubstr("on the imaginary axis"));
  EXPECT_THAT(r.warning, HasSubstr("Q has eigenvalue -2"));
  EXPECT_THAT(r.culprit, HasSubstr("Q has eigenvalue -2"));
  EXPECT_TRUE(r.X.array().isNaN().all());
  // N alone makes the cost of a double integrator indefinite.
  const RiccatiResult cross = care(matrix({{0, 1}, {0, 0}}), matrix({{0}, {1}}),
                                   MatrixXd::Identity(2, 2), matrix({{1}}), matrix({{5}, {5}}));
  EXPECT_EQ(cross.status, RiccatiStatus::boundary_pair) << cross;
  EXPECT_THAT(cross.culprit, HasSubstr("[Q N; N' R] has eigenvalue -6.07"));
  EXPECT_THAT(cross.culprit, HasSubstr("check the signs and the size of N"));
}

TEST(Riccati, AcceptsQIndefiniteByRoundingAndReportsMore) {
  const MatrixXd A = matrix({{-1, 1}, {0, 0.5}});
  const MatrixXd b = matrix({{0}, {1}});
  const MatrixXd one = matrix({{1}});
  const RiccatiResult rounding = care(A, b, matrix({{1, 0}, {0, -1e-16}}), one);
  EXPECT_TRUE(rounding.solved()) << rounding;
  EXPECT_TRUE(rounding.warning.empty());
  const MatrixXd negative = matrix({{1, 0}, {0, -1e-3}});
  const RiccatiResult more = care(A, b, negative, one);
  EXPECT_TRUE(more.solved()) << more;
  EXPECT_THAT(more.warning, HasSubstr("Q has eigenvalue -0.001, expected Q >= 0"));
  RiccatiOptions strict;
  strict.reject_indefinite_Q = true;
  EXPECT_THAT([&] { (void)care(A, b, negative, one, MatrixXd(), strict); },
              ThrowsMessage<InvalidInput>(HasSubstr("care: Q has eigenvalue -0.001")));
}

struct Refusal {
  RiccatiCase problem;
  bool discrete;
  std::string message;
};

TEST(Riccati, RefusesWrongInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const MatrixXd A = MatrixXd::Identity(2, 2);
  const MatrixXd B = matrix({{0}, {1}});
  const MatrixXd Q = MatrixXd::Identity(2, 2);
  const MatrixXd R = matrix({{1}});
  const MatrixXd R2 = matrix({{1, 2}, {2, 1}});
  const std::vector<Refusal> refusals = {
      {{MatrixXd(2, 3), B, Q, R}, false, "care: A is 2x3, expected a square matrix"},
      {{MatrixXd(), B, Q, R}, true, "dare: A is 0x0, expected a square matrix"},
      {{MatrixXd::Zero(4, 4), MatrixXd::Zero(3, 1), Q, R},
       false,
       "care: B is 3x1, expected 4 rows (A is 4x4)"},
      {{A, MatrixXd(2, 0), Q, R}, false, "care: B is 2x0, expected at least 1 column"},
      {{A, B, MatrixXd::Zero(3, 3), R}, false, "care: Q is 3x3, expected 2x2 (A is 2x2)"},
      {{A, B, Q, R2}, true, "dare: R is 2x2, expected 1x1 (B has 1 column)"},
      {{A, B, Q, R, MatrixXd::Zero(1, 2)},
       false,
       "care: N is 1x2, expected 2x1 (A is 2x2, B is 2x1)"},
      {{A * nan, B, Q, R}, false, "care: A has nan at (1,1), expected finite numbers"},
      {{A, B / 0.0, Q, R}, true, "dare: B has "},
      {{A, B, Q * nan, R}, false, "care: Q has nan at (1,1), expected finite numbers"},
      {{A, B, Q, R * nan}, false, "care: R has nan at (1,1), expected finite numbers"},
      {{A, B, Q, R, B * nan}, false, "care: N has nan at (1,1), expected finite numbers"},
      {{A, B, matrix({{1, 0.5}, {0.4, 1}}), R}, false, "which differ by 0.1"},
      {{A, A, Q, matrix({{1, 0.5}, {0.4, 1}})}, false, "care: R is not symmetric"},
      {{A, B, Q, matrix({{-0.1}})}, false, "care: R has eigenvalue -0.1, expected R > 0"},
      {{A, B, Q, matrix({{0}})}, false, "care: R has eigenvalue 0, expected R > 0"},
      {{A, A, Q, R2}, false, "care: R has eigenvalue -1, expected R > 0"},
      {{A, A, Q, matrix({{1, 1}, {1, 1}})}, false, "care: R has eigenvalue "},
      {{A, A, Q, R2}, true, "dare: R has eigenvalue -1, expected R >= 0"},
  };
  for (const Refusal& refusal : refusals) {
    EXPECT_THAT([&] { (void)solve_case(refusal.problem, refusal.discrete); },
                ThrowsMessage<InvalidInput>(HasSubstr(refusal.message)));
  }
}

TEST(Riccati, RefusesOptionsOutOfRange) {
  const MatrixXd one = matrix({{1}});
  const auto attempt = [&](const RiccatiOptions& options) {
    return [&one, options] { (void)care(one, one, one, one, MatrixXd(), options); };
  };
  RiccatiOptions options;
  options.max_iterations = 0;
  EXPECT_THAT(attempt(options),
              ThrowsMessage<InvalidInput>("care: max_iterations is 0, expected >= 1"));
  options = {};
  options.relative_tolerance = 0;
  EXPECT_THAT(attempt(options), ThrowsMessage<InvalidInput>(HasSubstr("relative_tolerance is 0")));
  EXPECT_THAT(attempt(named({"a", "b"})),
              ThrowsMessage<InvalidInput>("care: state_names has 2 names, expected 1 (A is 1x1)"));
}

TEST(Riccati, PrintsWhatHappened) {
  std::ostringstream text;
  text << care(matrix({{0}}), matrix({{0}}), matrix({{1}}), matrix({{1}}));
  EXPECT_EQ(text.str(), "not stabilizable (mode at 0: state 1 cannot be controlled)");
  EXPECT_EQ(to_string(RiccatiStatus::solved), "solved");
}

TEST(RiccatiCulprit, ReportsWeightsOfExtremeSize) {
  const testing::RiccatiCase hover = testing::small_hover();
  for (const double size : {1e-300, 1e300}) {
    const RiccatiResult r = care(hover.A, hover.B, size * hover.Q, hover.R);
    ASSERT_FALSE(r.solved());
    EXPECT_THAT(r.culprit, ::testing::Not(::testing::HasSubstr("cannot be controlled")));
    EXPECT_THAT(r.culprit, ::testing::HasSubstr("this may be due to rounding: entries reach"));
  }
}

}  // namespace
}  // namespace quadtune
