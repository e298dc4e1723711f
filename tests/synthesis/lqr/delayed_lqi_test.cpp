// SPDX-License-Identifier: Apache-2.0
/// LQR with integrals of outputs and with delayed inputs, against closed forms.
#include "quadtune/synthesis/delayed_lqi.hpp"

#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;

// x' = u, i' = x, cost i² + u²: the loop s² + √2 s + 1, hence K = [√2 1].
TEST(OutputIntegrals, OfAnIntegratorAreAClosedForm) {
  ContinuousLti plant;
  plant.A = MatrixXd::Zero(1, 1);
  plant.B = MatrixXd::Ones(1, 1);
  plant.C = MatrixXd::Ones(1, 1);
  const AugmentedLqr<ContinuousLti> augmented =
      with_output_integrals(plant, {MatrixXd{{0, 0}, {0, 1}}, MatrixXd::Ones(1, 1), {}});
  const RiccatiResult result = lqr(augmented.plant, augmented.weights);
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_THAT(result.K, MatrixNear(MatrixXd{{std::sqrt(2.0), 1}}, 1e-12));
}

TEST(OutputIntegrals, AreThoseOfTheListedStates) {
  ContinuousLti plant;
  plant.A = MatrixXd{{0, 1}, {0, -0.3}};
  plant.B = MatrixXd{{0}, {2}};
  plant.states = {{"x", "m"}, {"v", "m/s"}};
  const LqrWeights weights{Eigen::Vector3d(1, 2, 3).asDiagonal(), MatrixXd::Ones(1, 1), {}};
  const ContinuousLti by_name = with_integrals(plant, {"x"});
  plant.C = MatrixXd{{1, 0}};
  const AugmentedLqr<ContinuousLti> augmented = with_output_integrals(plant, weights);
  EXPECT_EQ(augmented.plant.A, by_name.A);
  EXPECT_EQ(augmented.plant.B, by_name.B);
}

// A discrete integrator in series: the feed-through enters the sum.
TEST(OutputIntegrals, OfADiscretePlant) {
  const DiscreteLti plant{
      MatrixXd{{0.5}}, MatrixXd{{1}}, MatrixXd{{3}}, MatrixXd{{0.1}}, 0.2, {}, {}, {}};
  const AugmentedLqr<DiscreteLti> augmented = with_output_integrals(
      plant, {MatrixXd::Identity(2, 2), MatrixXd::Ones(1, 1), MatrixXd::Zero(2, 1)});
  EXPECT_THAT(augmented.plant.A, MatrixNear(MatrixXd{{0.5, 0}, {0.6, 1}}, 1e-15));
  EXPECT_THAT(augmented.plant.B, MatrixNear(MatrixXd{{1}, {0.02}}, 1e-15));
}

// The optimal law of a delayed input predicts the state: K_x = K A^d, K_j = K A^(j-1) B.
TEST(InputDelay, LawPredictsTheState) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 12; ++trial) {
    const ContinuousLti drawn = testing::random_plant(3, 1 + trial % 2, 1, false, random);
    const Index nu = drawn.B.cols();
    AugmentedLqr<DiscreteLti> problem;
    problem.plant.A = 0.5 * drawn.A;
    problem.plant.B = drawn.B;
    problem.plant.dt = 0.01;
    problem.weights = {MatrixXd::Identity(3, 3), 2 * MatrixXd::Identity(nu, nu), {}};
    if (trial % 3 == 0) problem.weights.N = 0.2 * MatrixXd::Ones(3, nu);
    const MatrixXd K = lqr(problem.plant, problem.weights).K;
    for (const int delay : {0, 1, 3}) {
      const AugmentedLqr<DiscreteLti> delayed = with_input_delay(problem, delay);
      const RiccatiResult result = lqr(delayed.plant, delayed.weights);
      ASSERT_TRUE(result.solved()) << result;
      MatrixXd expected(nu, 3 + nu * delay);
      MatrixXd power = MatrixXd::Identity(3, 3);
      for (int j = 1; j <= delay; ++j) {
        expected.middleCols(3 + (j - 1) * nu, nu) = K * power * problem.plant.B;
        power = (power * problem.plant.A).eval();
      }
      expected.leftCols(3) = K * power;
      EXPECT_THAT(result.K, MatrixRelativelyNear(expected, 1e-9)) << trial << " " << delay;
    }
  }
}

TEST(InputDelay, OutOfRangeIsRejected) {
  AugmentedLqr<DiscreteLti> problem;
  problem.plant.A = problem.plant.B = MatrixXd::Ones(1, 1);
  problem.plant.dt = 1;
  problem.weights = {MatrixXd::Ones(1, 1), MatrixXd::Ones(1, 1), {}};
  EXPECT_THROW((void)with_input_delay(problem, -1), InvalidInput);
  EXPECT_THROW((void)with_input_delay(problem, 2001), InvalidInput);
  problem.weights.Q = MatrixXd::Ones(2, 2);
  EXPECT_THROW((void)with_input_delay(problem, 1), InvalidInput);
  EXPECT_THROW((void)with_output_integrals(problem.plant, {MatrixXd::Ones(1, 1), {}, {}}),
               InvalidInput);
}

}  // namespace
}  // namespace quadtune
