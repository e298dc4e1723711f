// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "plants/random_plant.hpp"
#include "plants/riccati_by_100_digits.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/diagonal_lqr.hpp"
#include "quadtune/synthesis/state_feedback.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::LongMatrix;
using testing::LongReal;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using testing::random_matrix;
using ::testing::ThrowsMessage;

MatrixXd one(double x) { return MatrixXd::Constant(1, 1, x); }

MatrixXd symmetric(const MatrixXd& M) { return 0.5 * (M + M.transpose()); }

/// A continuous or discrete plant with weights, including cross weights.
struct Problem {
  bool discrete = false;
  testing::RiccatiCase numbers;
  ContinuousLti continuous_plant;
  DiscreteLti discrete_plant;
  LqrWeights weights;

  [[nodiscard]] RiccatiResult solve(const LqrWeights& at) const {
    return discrete ? lqr(discrete_plant, at) : lqr(continuous_plant, at);
  }
  [[nodiscard]] LqrDerivative derivative() const {
    return discrete ? LqrDerivative(discrete_plant, weights, solve(weights))
                    : LqrDerivative(continuous_plant, weights, solve(weights));
  }
};

Problem random_problem(Index nx, Index nu, bool discrete, std::mt19937_64& random) {
  const testing::RiccatiCase c = testing::random_case(nx, nu, discrete, true, random);
  Problem problem;
  problem.discrete = discrete;
  problem.numbers = c;
  problem.continuous_plant = {c.A, c.B, {}, {}, {}, {}, {}};
  problem.discrete_plant = {c.A, c.B, {}, {}, 1, {}, {}, {}};
  problem.weights = {c.Q, c.R, c.N};
  return problem;
}

LqrWeights random_direction(Index nx, Index nu, std::mt19937_64& random) {
  return {symmetric(random_matrix(nx, nx, random)), symmetric(random_matrix(nu, nu, random)),
          random_matrix(nx, nu, random)};
}

/// Central differences of steps h, h/2 and h/4, extrapolated: their error is of the order h⁶.
template <class Function>
MatrixXd difference(Function&& f, double h) {
  const auto central = [&](double step) -> MatrixXd { return (f(step) - f(-step)) / (2 * step); };
  const MatrixXd coarse = central(h), middle = central(h / 2), fine = central(h / 4);
  const MatrixXd first = (4 * middle - coarse) / 3, second = (4 * fine - middle) / 3;
  return (16 * second - first) / 15;
}

/// Central differences of X and K along `direction`, in 100 digits, so that neither rounding nor
/// the step size affects the result in double precision.
LqrTangent long_difference(const Problem& problem, const LqrWeights& direction) {
  const testing::LongRiccatiCase at(problem.numbers);
  const LongMatrix dQ = direction.Q.cast<LongReal>();
  const LongMatrix dR = direction.R.cast<LongReal>();
  const LongMatrix dN = direction.N.cast<LongReal>();
  const LongMatrix K = problem.solve(problem.weights).K.cast<LongReal>();
  const LongReal h("1e-14");
  const auto solution = [&](const LongReal& t) {
    testing::LongRiccatiCase moved = at;
    moved.Q += t * dQ;
    moved.R += t * dR;
    moved.N += t * dN;
    return testing::by_100_digits(moved, problem.discrete, K).exact.value();
  };
  const testing::LongRiccatiSolution above = solution(h);
  const testing::LongRiccatiSolution below = solution(-h);
  const auto slope = [&](const LongMatrix& high, const LongMatrix& low) -> MatrixXd {
    return LongMatrix((high - low) / (2 * h)).cast<double>();
  };
  return {slope(above.X, below.X), slope(above.K, below.K)};
}

class BothTimes : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Time, BothTimes, ::testing::Bool(),
                         [](const auto& p) { return p.param ? "Discrete" : "Continuous"; });

TEST_P(BothTimes, TangentIsTheLimitOfDifferences) {
  std::mt19937_64 random(7);
  for (const Index nx : {1, 2, 5, 12})
    for (const Index nu : {1, 3}) {
      const Problem problem = random_problem(nx, nu, GetParam(), random);
      const LqrWeights direction = random_direction(nx, nu, random);
      const LqrTangent tangent = problem.derivative().along(direction);
      const LqrTangent expected = long_difference(problem, direction);
      // X and K in double precision, from which the tangent is computed, have errors of 1e-12.
      EXPECT_THAT(tangent.dX, MatrixRelativelyNear(expected.dX, 1e-10)) << nx << " " << nu;
      EXPECT_THAT(tangent.dK, MatrixRelativelyNear(expected.dK, 1e-10)) << nx << " " << nu;
    }
}

// Σ Y∘dK by the tangent and by the gradient.
TEST_P(BothTimes, GradientIsTheAdjointOfTheTangent) {
  std::mt19937_64 random(11);
  for (const Index nx : {1, 3, 8, 16}) {
    const Index nu = nx > 3 ? 4 : 1;
    const Problem problem = random_problem(nx, nu, GetParam(), random);
    const LqrDerivative at = problem.derivative();
    const MatrixXd Y = random_matrix(nu, nx, random);
    const LqrWeights g = at.gradient(Y);
    const LqrWeights d = random_direction(nx, nu, random);
    const MatrixXd dK = at.along(d).dK;
    const double forward = Y.cwiseProduct(dK).sum();
    const double back =
        g.Q.cwiseProduct(d.Q).sum() + g.R.cwiseProduct(d.R).sum() + g.N.cwiseProduct(d.N).sum();
    EXPECT_NEAR(forward, back, 1e-12 * Y.norm() * dK.norm()) << nx;
    EXPECT_THAT(g.Q, MatrixNear(g.Q.transpose().eval(), 0));
    EXPECT_THAT(g.R, MatrixNear(g.R.transpose().eval(), 0));
  }
}

// A cost that is multiplied by a number has the same gain, and X is multiplied by the number.
TEST_P(BothTimes, ScalingTheCostMovesXAndNotK) {
  std::mt19937_64 random(13);
  const Problem problem = random_problem(9, 2, GetParam(), random);
  const RiccatiResult solution = problem.solve(problem.weights);
  const LqrTangent tangent = problem.derivative().along(problem.weights);
  EXPECT_LT(tangent.dK.norm(), 1e-12 * solution.K.norm());
  EXPECT_THAT(tangent.dX, MatrixRelativelyNear(solution.X, 1e-12));
}

// ẋ = a x + b u: k = (a + √(a² + b² q/r))/b, so dk/dq = b/(2 r √·) and dk/dr = -(q/r) dk/dq.
TEST(LqrDerivative, ScalarContinuousInClosedForm) {
  const double a = 0.7, b = -2, q = 3, r = 0.4;
  const double root = std::sqrt(a * a + b * b * q / r);
  const ContinuousLti plant = {one(a), one(b), {}, {}, {}, {}, {}};
  const LqrWeights weights = {one(q), one(r), {}};
  const RiccatiResult solution = lqr(plant, weights);
  ASSERT_NEAR(solution.K(0, 0), (a + root) / b, 1e-14);
  const LqrDerivative at(plant, weights, solution);
  const double by_q = b / (2 * r * root);
  EXPECT_NEAR(at.along({one(1), {}, {}}).dK(0, 0), by_q, 1e-14);
  EXPECT_NEAR(at.along({{}, one(1), {}}).dK(0, 0), -q / r * by_q, 1e-13);
  EXPECT_NEAR(at.gradient(one(1)).Q(0, 0), by_q, 1e-14);
  EXPECT_NEAR(at.gradient(one(1)).R(0, 0), -q / r * by_q, 1e-13);
}

// x' = x + u, r = 1: X² = q (1 + X), so dX/dq = (1 + X)/(2X - q), K = X/(1 + X). At q = 1 X is the
// golden ratio φ and dK/dq = 1/((1 + φ)(2φ - 1)).
TEST(LqrDerivative, ScalarDiscreteInClosedForm) {
  const double phi = std::numbers::phi;
  const DiscreteLti plant = {one(1), one(1), {}, {}, 1, {}, {}, {}};
  const LqrWeights weights = {one(1), one(1), {}};
  const LqrDerivative at(plant, weights, lqr(plant, weights));
  const LqrTangent tangent = at.along({one(1), {}, {}});
  EXPECT_NEAR(tangent.dX(0, 0), (1 + phi) / (2 * phi - 1), 1e-14);
  EXPECT_NEAR(tangent.dK(0, 0), 1 / ((1 + phi) * (2 * phi - 1)), 1e-14);
}

TEST(LqrDerivative, RejectsUnsolvedProblemsAndWrongShapes) {
  const ContinuousLti plant = {one(1), one(1), {}, {}, {}, {}, {}};
  const LqrWeights weights = {one(1), one(1), {}};
  EXPECT_THAT(([&] { (void)LqrDerivative(plant, weights, RiccatiResult{}); }),
              ThrowsMessage<InvalidInput>(
                  HasSubstr("lqr_derivative: the Riccati equation has status 'not run', expected "
                            "'solved'")));
  const LqrDerivative at(plant, weights, lqr(plant, weights));
  EXPECT_THAT(([&] {
                (void)at.along({MatrixXd::Identity(2, 2), {}, {}});
              }),
              ThrowsMessage<InvalidInput>(HasSubstr("lqr_derivative: dQ is 2x2, expected 1x1")));
  EXPECT_THAT(([&] { (void)at.gradient(one(std::numeric_limits<double>::quiet_NaN())); }),
              ThrowsMessage<InvalidInput>(HasSubstr("Y has nan at (1,1)")));
}

// --- diagonal weights of a design ----------------------------------------------------------------

/// A plant of states s1 … and inputs u1 …, two of its states integrated, diagonal weights over two
/// decades.
struct DesignCase {
  ContinuousLti plant;
  LqrDesign design;
  VectorXd w;
};

DesignCase random_design(LqrMethod method, std::mt19937_64& random) {
  constexpr Index nx = 6, nu = 3, ni = 2;
  DesignCase c;
  c.plant = testing::random_plant(nx, nu, nx, false, random);
  for (Index i = 1; i <= nx; ++i) c.plant.states.push_back({"s" + std::to_string(i), ""});
  for (Index i = 1; i <= nu; ++i) c.plant.inputs.push_back({"u" + std::to_string(i), ""});
  c.design.integrals = {"s2", "s5"};
  c.design.method = method;
  c.design.dt = 0.05;
  c.design.Q.setZero(nx, nx);
  c.design.Q_integral.setZero(ni, ni);
  c.design.R.setZero(nu, nu);
  std::uniform_real_distribution<double> decade(-1, 1);
  c.w = VectorXd::NullaryExpr(nx + ni + nu, [&] { return std::pow(10, decade(random)); });
  c.design = with_diagonals(c.design, c.w);
  return c;
}

class EveryMethod : public ::testing::TestWithParam<LqrMethod> {};
INSTANTIATE_TEST_SUITE_P(Method, EveryMethod,
                         ::testing::Values(LqrMethod::continuous, LqrMethod::discrete,
                                           LqrMethod::sampled),
                         [](const auto& p) { return to_string(p.param); });

TEST_P(EveryMethod, DiagonalLqrIsTheDesignsOwn) {
  std::mt19937_64 random(17);
  const DesignCase c = random_design(GetParam(), random);
  const DiagonalLqr problem(c.plant, c.design);
  EXPECT_EQ(problem.size(), 11);
  EXPECT_EQ(problem.names()[6], "int_s2");
  EXPECT_EQ(problem.names()[8], "u1");
  EXPECT_THAT(diagonals_of(c.design), MatrixNear(c.w, 0));
  const StateFeedback feedback = state_feedback(c.plant, c.design);
  EXPECT_THAT(problem.solve(c.w).K, MatrixRelativelyNear(feedback.riccati.K, 1e-12));
}

TEST_P(EveryMethod, JacobianIsTheLimitOfDifferencesOfTheDesign) {
  std::mt19937_64 random(19);
  const DesignCase c = random_design(GetParam(), random);
  const DiagonalLqr problem(c.plant, c.design);
  const MatrixXd J = problem.jacobian(c.w, problem.solve(c.w));
  ASSERT_EQ(J.rows(), 3 * 8);
  MatrixXd differences(J.rows(), J.cols());
  for (Index i = 0; i < J.cols(); ++i) {
    const auto K = [&](double t) -> MatrixXd {
      VectorXd w = c.w;
      w(i) *= 1 + t;
      const StateFeedback f = state_feedback(c.plant, with_diagonals(c.design, w));
      return f.riccati.K.reshaped();
    };
    differences.col(i) = difference(K, 1e-2) / c.w(i);
  }
  for (Index i = 0; i < J.cols(); ++i)
    EXPECT_THAT(J.col(i), MatrixRelativelyNear(differences.col(i).eval(), 1e-7))
        << problem.names()[static_cast<std::size_t>(i)];
  // A common factor of all weights does not affect the gain.
  EXPECT_LT((J * c.w).norm(), 1e-12 * J.norm() * c.w.norm());
}

TEST_P(EveryMethod, GradientIsTheJacobianTransposed) {
  std::mt19937_64 random(23);
  const DesignCase c = random_design(GetParam(), random);
  const DiagonalLqr problem(c.plant, c.design);
  const RiccatiResult solution = problem.solve(c.w);
  const MatrixXd Y = random_matrix(3, 8, random);
  const VectorXd expected = problem.jacobian(c.w, solution).transpose() * Y.reshaped();
  EXPECT_THAT(problem.gradient(c.w, solution, Y), MatrixRelativelyNear(expected, 1e-12));
}

// The stiffest available problem: chains of four integrators, 16 states, weights of 1e3 and 1e-2.
TEST(DiagonalLqr, JacobianOfTheUquadsHover) {
  LqrDesign design;
  design.integrals = {"x", "y", "z", "theta"};
  design.method = LqrMethod::discrete;
  design.dt = 0.01;
  const ContinuousLti plant = testing::uquad_hover();
  const DiagonalLqr problem(plant, design);
  VectorXd w = VectorXd::Ones(20);
  w.segment(3, 3).setConstant(1e3);
  w.tail(4).setConstant(0.01);
  const RiccatiResult solution = problem.solve(w);
  const MatrixXd J = problem.jacobian(w, solution);
  for (const Index i : {0, 3, 5, 6, 12, 15, 16}) {
    const auto K = [&](double t) -> MatrixXd {
      VectorXd there = w;
      there(i) *= 1 + t;
      return problem.solve(there).K.reshaped();
    };
    EXPECT_THAT((J.col(i) * w(i)).eval(), MatrixRelativelyNear(difference(K, 2e-2), 1e-6)) << i;
  }
}

TEST(DiagonalLqr, RejectsInvalidWeights) {
  std::mt19937_64 random(29);
  DesignCase c = random_design(LqrMethod::discrete, random);
  const DiagonalLqr problem(c.plant, c.design);
  EXPECT_THAT(([&] { (void)problem.solve(VectorXd::Ones(10)); }),
              ThrowsMessage<InvalidInput>(HasSubstr("10 weights are given, expected 11 (s1 s2")));
  c.w(6) = -1;
  EXPECT_THAT(
      ([&] { (void)problem.solve(c.w); }),
      ThrowsMessage<InvalidInput>(HasSubstr("the weight of int_s2 is -1, expected 0 or more")));
  c.design.Q(0, 1) = c.design.Q(1, 0) = 0.1;
  EXPECT_THAT(([&] { (void)diagonals_of(c.design); }),
              ThrowsMessage<InvalidInput>(HasSubstr("Q has entries off its diagonal")));
  c.design.dt = 0;
  EXPECT_THAT(([&] { (void)DiagonalLqr(c.plant, c.design); }),
              ThrowsMessage<InvalidInput>(HasSubstr("dt is 0 s, expected a positive number")));
}

}  // namespace
}  // namespace quadtune
