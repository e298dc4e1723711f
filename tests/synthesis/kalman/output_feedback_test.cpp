// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/output_feedback.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

MatrixXd random_matrix(std::mt19937& random, Index rows, Index cols) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// A plant with N different matrices, each with |eigenvalues| < 1, and fully coupled weights.
OutputFeedbackProblem random_problem(std::mt19937& random, std::size_t N, Index nx, Index nu,
                                     Index ny) {
  OutputFeedbackProblem problem;
  problem.plant.dt = 0.1;
  for (std::size_t k = 0; k < N; ++k) {
    const MatrixXd A = random_matrix(random, nx, nx);
    problem.plant.A.push_back(0.8 / A.eigenvalues().cwiseAbs().maxCoeff() * A);
    problem.plant.B.push_back(random_matrix(random, nx, nu));
  }
  problem.plant.C = random_matrix(random, ny, nx);
  const MatrixXd L = random_matrix(random, nx, nx), M = random_matrix(random, nu, nu);
  problem.Q = L * L.transpose();
  problem.R = M * M.transpose();
  problem.start = random_matrix(random, nx, 2);
  return problem;
}

/// Small gains with which the loop is stable.
MatrixXd mild_gain(std::mt19937& random, const OutputFeedbackProblem& problem) {
  MatrixXd F = random_matrix(random, problem.R.rows(), problem.plant.C.rows());
  while (!output_feedback_cost(problem, F).stable) F /= 2;
  return F;
}

TEST(OutputFeedback, CostIsTheSumOfASimulation) {
  std::mt19937 random(1);
  for (const std::size_t N : {1U, 2U, 5U}) {
    const OutputFeedbackProblem problem = random_problem(random, N, 6, 2, 3);
    const MatrixXd F = mild_gain(random, problem);
    MatrixXd x = problem.start;
    double sum = 0;
    for (std::size_t k = 0; k < 100000 && x.norm() > 1e-12; ++k) {
      const MatrixXd u = -F * problem.plant.C * x;
      sum += x.cwiseProduct(problem.Q * x).sum() + u.cwiseProduct(problem.R * u).sum();
      x = (problem.plant.A[k % N] * x + problem.plant.B[k % N] * u).eval();
    }
    EXPECT_NEAR(output_feedback_cost(problem, F).cost, sum, 1e-9 * sum);
  }
}

/// Central differences with Richardson's extrapolation, whose error is of the order h⁴.
TEST(OutputFeedback, SlopeMatchesDifferences) {
  std::mt19937 random(2);
  for (const std::size_t N : {1U, 3U, 10U}) {
    const OutputFeedbackProblem problem = random_problem(random, N, 5, 2, 4);
    const MatrixXd F = mild_gain(random, problem) / 2;
    const OutputFeedbackCost at = output_feedback_cost(problem, F);
    ASSERT_TRUE(at.stable);
    const double scale = at.slope.cwiseAbs().maxCoeff();
    for (Index i = 0; i < F.rows(); ++i)
      for (Index j = 0; j < F.cols(); ++j) {
        const auto difference = [&](double h) {
          MatrixXd up = F, down = F;
          up(i, j) += h;
          down(i, j) -= h;
          return (output_feedback_cost(problem, up).cost -
                  output_feedback_cost(problem, down).cost) /
                 (2 * h);
        };
        const double h = 1e-4 * F.norm();
        const double slope = (4 * difference(h / 2) - difference(h)) / 3;
        EXPECT_NEAR(at.slope(i, j), slope, 1e-6 * scale) << N << " " << i << " " << j;
      }
  }
}

/// x⁺ = a x + b u, u = -f x: x0² (q + r f²)/(1 - (a - b f)²).
TEST(OutputFeedback, MatchesTheClosedFormOfOneState) {
  OutputFeedbackProblem problem;
  problem.plant.A = {MatrixXd::Constant(1, 1, 1.2)};
  problem.plant.B = {MatrixXd::Constant(1, 1, 0.5)};
  problem.plant.C = MatrixXd::Identity(1, 1);
  problem.plant.dt = 1;
  problem.Q = MatrixXd::Constant(1, 1, 2);
  problem.R = MatrixXd::Constant(1, 1, 3);
  problem.start = MatrixXd::Constant(1, 1, 0.7);
  const MatrixXd F = MatrixXd::Constant(1, 1, 0.9);
  const double a = 1.2 - 0.5 * 0.9;
  EXPECT_NEAR(output_feedback_cost(problem, F).cost, 0.49 * (2 + 3 * 0.81) / (1 - a * a), 1e-14);
  // 1.2 - 0.5 f = ±1: the response neither converges nor diverges; the loop is not stable.
  for (const double f : {0.4, 4.4, 0.3, 5.0}) {
    const OutputFeedbackCost cost = output_feedback_cost(problem, MatrixXd::Constant(1, 1, f));
    EXPECT_FALSE(cost.stable) << f;
    EXPECT_TRUE(std::isinf(cost.cost));
    EXPECT_TRUE(std::isnan(cost.slope(0, 0)));
  }
}

TEST(OutputFeedback, OfAllStatesIsStationaryAtTheRegulator) {
  std::mt19937 random(3);
  OutputFeedbackProblem problem = random_problem(random, 1, 5, 2, 5);
  problem.plant.C = MatrixXd::Identity(5, 5);
  problem.plant.A[0] *= 1.5;  // unstable without the law
  const RiccatiResult riccati = dare(problem.plant.A[0], problem.plant.B[0], problem.Q, problem.R);
  ASSERT_TRUE(riccati.solved());
  const OutputFeedbackCost cost = output_feedback_cost(problem, riccati.K);
  ASSERT_TRUE(cost.stable);
  EXPECT_LT(cost.slope.cwiseAbs().maxCoeff() * riccati.K.cwiseAbs().maxCoeff(), 1e-9 * cost.cost);
  EXPECT_NEAR(cost.cost, problem.start.cwiseProduct(riccati.X * problem.start).sum(),
              1e-10 * cost.cost);
}

/// The law i⁺ = i + dt y, u = -F y - G (i + now dt y) is equivalent to the plant with an appended
/// integral.
TEST(OutputFeedback, IntegralsAreThoseOfTheLaw) {
  std::mt19937 random(4);
  const OutputFeedbackProblem problem = random_problem(random, 2, 3, 1, 2);
  for (const double now : {0.0, 0.5, 1.0}) {
    const PeriodicLti with = with_integrals(problem.plant, {1}, now);
    ASSERT_EQ(with.C.rows(), 3);
    const MatrixXd F = random_matrix(random, 1, 3);
    VectorXd z = VectorXd::Zero(4);
    z.head(3) = problem.start.col(0);
    VectorXd x = problem.start.col(0);
    double integral = 0;
    for (std::size_t k = 0; k < 5; ++k) {
      const VectorXd y = problem.plant.C * x;
      const double dt = problem.plant.dt;
      const double u = -(F(0, 0) * y(0) + F(0, 1) * y(1) + F(0, 2) * (integral + now * dt * y(1)));
      EXPECT_NEAR(-(F * with.C * z)(0), u, 1e-13 * std::abs(u));
      z = (with.A[k % 2] * z + with.B[k % 2] * u).eval();
      x = (problem.plant.A[k % 2] * x + problem.plant.B[k % 2] * u).eval();
      integral += dt * y(1);
    }
    EXPECT_NEAR(z(3), integral, 1e-13);
  }
}

/// L = -3/4 violates Ms ≤ 2 by 1 - 2/4 and a disk of 1/2 by 7/16 - 1/4; L = 1 violates neither.
TEST(MarginPenalty, IsTheSumOfSquaresOfTheViolations) {
  Eigen::MatrixXcd response(1, 2);
  response << -0.75, 1.0;
  const Eigen::RowVectorXd one = Eigen::RowVectorXd::Ones(1);
  EXPECT_NEAR(margin_penalty(response, one, {2, 0.5}).penalty, 0.25 + 0.1875 * 0.1875, 1e-15);
  const MarginPenalty none = margin_penalty(response.rightCols(1), one, {2, 0.5});
  EXPECT_EQ(none.penalty, 0);
  EXPECT_TRUE(none.slope.isZero(0));
}

TEST(MarginPenalty, SlopeMatchesDifferences) {
  std::mt19937 random(6);
  const Eigen::MatrixXcd response =
      random_matrix(random, 3, 20) + std::complex<double>(0, 1) * random_matrix(random, 3, 20);
  const Eigen::RowVectorXd F = 0.3 * random_matrix(random, 1, 3);
  const MarginBounds bounds{1.7, 0.6};
  const MarginPenalty at = margin_penalty(response, F, bounds);
  ASSERT_GT(at.penalty, 0.01);
  for (Index j = 0; j < 3; ++j) {
    Eigen::RowVectorXd up = F, down = F;
    up(j) += 1e-6;
    down(j) -= 1e-6;
    const double slope = (margin_penalty(response, up, bounds).penalty -
                          margin_penalty(response, down, bounds).penalty) /
                         2e-6;
    EXPECT_NEAR(at.slope(j), slope, 1e-7 * at.slope.norm());
  }
}

TEST(OutputFeedback, RefusesWhatDoesNotFit) {
  std::mt19937 random(7);
  const OutputFeedbackProblem problem = random_problem(random, 1, 3, 1, 2);
  EXPECT_THAT([&] { (void)output_feedback_cost(problem, MatrixXd::Zero(1, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("output feedback: F is 1x3, expected 1x2")));
  OutputFeedbackProblem bad = problem;
  bad.Q(0, 1) = std::nan("");
  EXPECT_THAT([&] { (void)output_feedback_cost(bad, MatrixXd::Zero(1, 2)); },
              ThrowsMessage<InvalidInput>(HasSubstr("output feedback: Q has nan at (1,2)")));
  EXPECT_THAT(
      [&] { (void)with_integrals(problem.plant, {2}, 0); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "output feedback: output 2 cannot be integrated, expected an index from 0 to 1")));
  EXPECT_THAT(
      [&] { (void)margin_penalty(Eigen::MatrixXcd::Zero(2, 1), Eigen::RowVectorXd::Zero(3), {}); },
      ThrowsMessage<InvalidInput>(
          HasSubstr("output feedback: the response has 2 outputs, expected 3")));
}

}  // namespace
}  // namespace quadtune
