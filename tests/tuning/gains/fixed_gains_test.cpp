// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/fixed_gains.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

MatrixXd random_matrix(std::mt19937& random, Index rows, Index cols) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

FixedGainsMember random_member(std::mt19937& random, Index nx, Index nu) {
  FixedGainsMember member;
  member.name = "random";
  PeriodicLti& plant = member.problem.plant;
  plant.dt = 0.1;
  const MatrixXd A = random_matrix(random, nx, nx);
  plant.A = {1.1 / A.eigenvalues().cwiseAbs().maxCoeff() * A};
  plant.B = {random_matrix(random, nx, nu)};
  plant.C = MatrixXd::Identity(nx, nx);
  member.problem.Q = MatrixXd::Identity(nx, nx);
  member.problem.R = MatrixXd::Identity(nu, nu);
  member.problem.start = MatrixXd::Identity(nx, nx);
  return member;
}

MatrixXd regulator(const OutputFeedbackProblem& problem) {
  return dare(problem.plant.A[0], problem.plant.B[0], problem.Q, problem.R).K;
}

/// If all states are fed back, the search must find the solution of the Riccati equation.
TEST(FixedGains, OfAllStatesEqualTheLqrGain) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 5; ++trial) {
    const FixedGainsMember member = random_member(random, 4, 2);
    const MatrixXd K = regulator(member.problem);
    MatrixXd start = K + 0.3 * K.norm() * random_matrix(random, 2, 4);
    while (!output_feedback_cost(member.problem, start).stable) start = (start + K) / 2;
    const FixedGainsResult result = fixed_gains({member}, start);
    ASSERT_TRUE(result.solved()) << to_string(result.status) << result.culprit;
    EXPECT_THAT(result.F, MatrixRelativelyNear(K, 1e-6));
    EXPECT_LT(result.cost, result.start_cost);
    EXPECT_LT(result.slope, 1e-6);
  }
}

/// Entries of 0 stay 0; no neighbour within the structure costs less, and every member is stable.
TEST(FixedGains, AreAMinimumOfTheirStructure) {
  std::mt19937 random(12);
  const FixedGainsMember one = random_member(random, 4, 2);
  FixedGainsMember two = one;
  two.problem.plant.A[0] += 0.03 * random_matrix(random, 4, 4);
  two.weight = 0.5;
  MatrixXd start = regulator(one.problem);
  start(0, 1) = 0;
  for (int i = 0; i < 20 && !(output_feedback_cost(one.problem, start).stable &&
                              output_feedback_cost(two.problem, start).stable);
       ++i)
    start(0, 1) = 0.2 * random_matrix(random, 1, 1)(0, 0);
  const FixedGainsResult result = fixed_gains({one, two}, start);
  ASSERT_TRUE(result.solved()) << to_string(result.status) << result.culprit;
  const auto cost = [&](const MatrixXd& F) {
    return output_feedback_cost(one.problem, F).cost +
           0.5 * output_feedback_cost(two.problem, F).cost;
  };
  EXPECT_NEAR(result.cost, cost(result.F), 1e-12 * result.cost);
  for (Index i = 0; i < start.rows(); ++i)
    for (Index j = 0; j < start.cols(); ++j) {
      if (start(i, j) == 0) {
        EXPECT_EQ(result.F(i, j), 0);
        continue;
      }
      for (const double change : {-1e-3, 1e-3}) {
        MatrixXd F = result.F;
        F(i, j) += change;
        EXPECT_GT(cost(F), result.cost);
      }
    }
}

/// A mass with a lagging actuator, position and velocity fed back: without bounds Ms of the loop is
/// above 1.5, with them it is not.
TEST(FixedGains, KeepTheirBounds) {
  FixedGainsMember member;
  member.name = "mass";
  PeriodicLti& plant = member.problem.plant;
  plant.dt = 0.01;
  const double share = 0.1, dt = plant.dt;
  plant.A = {(MatrixXd(3, 3) << 1, dt, 0, 0, 1, dt, 0, 0, 1 - share).finished()};
  plant.B = {(MatrixXd(3, 1) << 0, 0, share).finished()};
  plant.C = MatrixXd::Identity(2, 3);
  member.problem.Q = Eigen::Vector3d(1, 0, 0).asDiagonal();
  member.problem.R = MatrixXd::Constant(1, 1, 1e-3);
  member.problem.start = Eigen::Vector3d(1, 0, 0);
  const MatrixXd start = (MatrixXd(1, 2) << 1, 1.5).finished();
  const FixedGainsResult free = fixed_gains({member}, start);
  ASSERT_TRUE(free.solved());
  const MeanResponse response(plant);
  member.response.resize(2, 200);
  for (Index i = 0; i < 200; ++i)
    member.response.col(i) = response.at(0.1 * std::pow(3000.0, static_cast<double>(i) / 200));
  member.bounds = {1.5, 0.8};
  const auto Ms = [&](const MatrixXd& F) {
    return (1 + (F * member.response).array()).abs().inverse().maxCoeff();
  };
  EXPECT_GT(Ms(free.F), 1.55);
  const FixedGainsResult bounded = fixed_gains({member}, start);
  ASSERT_TRUE(bounded.solved()) << to_string(bounded.status) << bounded.violation;
  EXPECT_LT(Ms(bounded.F), 1.5 * 1.001);
  EXPECT_GT(bounded.cost, free.cost);
}

/// A tilt, its rate, a lagging rotor, and the position that the tilt moves. The outer loop is
/// opened at the command of the tilt, with the inner loop closed in its plant.
TEST(FixedGains, KeepTheBoundOfTheOuterLoop) {
  FixedGainsMember member;
  member.name = "chain";
  PeriodicLti& plant = member.problem.plant;
  const double dt = plant.dt = 0.01, lag = 0.15;
  MatrixXd A = MatrixXd::Identity(5, 5);
  A(0, 1) = A(2, 3) = A(3, 4) = dt;
  A(1, 2) = 9.81 * dt;
  A(4, 4) = 1 - lag;
  plant.A = {A};
  plant.B = {lag * MatrixXd::Identity(5, 5).col(4)};
  plant.C = MatrixXd::Identity(4, 5);
  member.problem.Q =
      (Eigen::VectorXd(5) << 16, 4, 25, 0.25, 0).finished().asDiagonal().toDenseMatrix();
  member.problem.R = MatrixXd::Constant(1, 1, 1e-3);
  member.problem.start = MatrixXd::Identity(5, 5).col(0);
  const MatrixXd start = (MatrixXd(1, 4) << 2, 3, 30, 8).finished();
  const auto grid = [](Index i) { return 0.1 * std::pow(3000.0, static_cast<double>(i) / 200); };
  const auto outer_Ms = [&](const MatrixXd& F) {
    PeriodicLti inner = plant;
    inner.A[0] -= plant.B[0] * F.rightCols(2) * plant.C.bottomRows(2);
    const MeanResponse response(inner);
    double Ms = 0;
    for (Index i = 0; i < 200; ++i) {
      const std::complex<double> L = (F.leftCols(2) * response.at(grid(i)).topRows(2)).value();
      Ms = std::max(Ms, 1 / std::abs(1.0 + L));
    }
    return Ms;
  };
  const FixedGainsResult free = fixed_gains({member}, start);
  ASSERT_TRUE(free.solved()) << to_string(free.status);
  const MeanResponse response(plant);
  member.response.resize(4, 200);
  for (Index i = 0; i < 200; ++i) member.response.col(i) = response.at(grid(i));
  member.bounds = {10, 0.01};
  member.inner = {2, 3};
  member.outer_Ms = 1 + 0.6 * (outer_Ms(free.F) - 1);
  const FixedGainsResult bounded = fixed_gains({member}, start);
  ASSERT_TRUE(bounded.solved()) << to_string(bounded.status) << bounded.violation;
  EXPECT_LT(outer_Ms(bounded.F), member.outer_Ms * 1.001);
  EXPECT_GT(outer_Ms(bounded.F), member.outer_Ms * 0.95);  // and close to the bound
  EXPECT_GT(bounded.cost, free.cost);
}

TEST(FixedGains, NameTheMemberThatIsUnstableAtTheStart) {
  std::mt19937 random(13);
  FixedGainsMember good = random_member(random, 3, 1);
  good.problem.plant.A[0] *= 0.5;
  FixedGainsMember bad = good;
  bad.name = "heavy";
  bad.problem.plant.A[0] *= 3;
  const FixedGainsResult result = fixed_gains({good, bad}, MatrixXd::Constant(1, 3, 1e-6));
  EXPECT_EQ(result.status, FixedGainsStatus::unstable_start);
  EXPECT_EQ(result.culprit, "heavy");
}

TEST(FixedGains, RejectInvalidInput) {
  std::mt19937 random(14);
  FixedGainsMember member = random_member(random, 3, 2);
  const MatrixXd start = MatrixXd::Ones(2, 3);
  EXPECT_THAT([&] { (void)fixed_gains({}, start); },
              ThrowsMessage<InvalidInput>(HasSubstr("fixed gains: there is no member")));
  EXPECT_THAT([&] { (void)fixed_gains({member}, MatrixXd::Zero(2, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("fixed gains: every starting gain is 0")));
  FixedGainsOptions options;
  options.max_iterations = 0;
  EXPECT_THAT([&] { (void)fixed_gains({member}, start, options); },
              ThrowsMessage<InvalidInput>(HasSubstr("max_iterations is 0, expected at least 1")));
  member.weight = -1;
  EXPECT_THAT([&] { (void)fixed_gains({member}, start); },
              ThrowsMessage<InvalidInput>(HasSubstr("the weight of 'random' is -1")));
  member.weight = 1;
  member.response = Eigen::MatrixXcd::Zero(3, 1);
  EXPECT_THAT([&] { (void)fixed_gains({member}, start); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("the law has 2 inputs; expected a law with one input")));
  FixedGainsMember single = random_member(random, 3, 1);
  single.response = Eigen::MatrixXcd::Zero(3, 1);
  single.bounds.Ms = 1;
  EXPECT_THAT([&] { (void)fixed_gains({single}, MatrixXd::Ones(1, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("are Ms 1 and disk 0.5; expected Ms > 1")));
  single.bounds.Ms = 2;
  single.inner = {3};
  EXPECT_THAT([&] { (void)fixed_gains({single}, MatrixXd::Ones(1, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("output 4 of the inner loop of 'random'")));
  single.outer_Ms = 1;
  EXPECT_THAT([&] { (void)fixed_gains({single}, MatrixXd::Ones(1, 3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("Ms 1, expected more than 1")));
}

}  // namespace
}  // namespace quadtune
