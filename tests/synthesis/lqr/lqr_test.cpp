// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/lqr.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

Eigen::MatrixXd diagonal(std::initializer_list<double> entries) {
  return Eigen::Map<const Eigen::VectorXd>(entries.begin(),
                                           static_cast<Eigen::Index>(entries.size()))
      .asDiagonal();
}

ContinuousLti double_integrator() {
  ContinuousLti plant;
  plant.A = (Eigen::MatrixXd(2, 2) << 0, 1, 0, 0).finished();
  plant.B = (Eigen::MatrixXd(2, 1) << 0, 1).finished();
  plant.states = {{"y", "m"}, {"vy", "m/s"}};
  return plant;
}

// Kwakernaak and Sivan 1972: weight 1 on position and input gives K = [1 sqrt(2)].
TEST(Lqr, DoubleIntegratorInClosedForm) {
  const RiccatiResult result = lqr(double_integrator(), {diagonal({1, 0}), diagonal({1}), {}});
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_THAT(result.K, MatrixNear(Eigen::RowVector2d(1, std::numbers::sqrt2), 1e-14));
}

// a = b = q = r = 1: X = 1 + X/(1 + X), the golden ratio.
TEST(Lqr, ScalarDiscreteIsTheGoldenRatio) {
  DiscreteLti plant;
  plant.A = plant.B = Eigen::MatrixXd::Ones(1, 1);
  plant.dt = 1;
  const RiccatiResult result = lqr(plant, {diagonal({1}), diagonal({1}), {}});
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_NEAR(result.X(0, 0), std::numbers::phi, 1e-14);
  EXPECT_NEAR(result.K(0, 0), std::numbers::phi / (1 + std::numbers::phi), 1e-14);
}

// docs/uquad-gains.md: the problem behind the public K_full.txt, solved to convergence. The yaw
// pair (theta, wqz) decouples; a 60-digit recursion of it alone gives -152.076695562187 and
// -40.412348071476.
TEST(Lqr, UquadHoverConvergedRow) {
  const DiscreteLti plant = discretize_zoh(testing::uquad_hover(), 0.01);
  const RiccatiResult result = lqr(plant, {diagonal({1, 1, 1, 1e3, 1e3, 1e3, 1, 1, 1, 1, 1, 1}),
                                           0.01 * Eigen::MatrixXd::Identity(4, 4),
                                           {}});
  ASSERT_TRUE(result.solved()) << result;
  Eigen::RowVectorXd row(12);
  row << -6.4229039009, 0, 4.9784193008, 0, -224.5832238898, -152.0766955622, -18.3121970818, 0,
      13.3890015616, 0, -26.0617723279, -40.4123480715;
  EXPECT_THAT(result.K.row(0), MatrixNear(row, 1e-9));
}

TEST(Lqr, SampledCostTendsToTheContinuousGain) {
  const ContinuousLti plant = testing::uquad_hover();
  const LqrWeights weights = {
      Eigen::MatrixXd::Identity(12, 12), Eigen::MatrixXd::Identity(4, 4), {}};
  const Eigen::MatrixXd K = lqr(plant, weights).K;
  double previous = 0;
  for (const double dt : {4e-3, 2e-3, 1e-3}) {
    const SampledLqr sampled = sample(plant, weights, dt);
    const RiccatiResult result = lqr(sampled.plant, sampled.weights);
    ASSERT_TRUE(result.solved()) << result;
    const double error = (result.K - K).norm() / K.norm();
    if (previous > 0) {
      EXPECT_NEAR(previous / error, 2, 0.05) << dt;  // first order in dt
    }
    previous = error;
  }
  EXPECT_LT(previous, 5e-3);
}

// The optimal sampled cost is not smaller than the continuous one, whose input may change at any
// time.
TEST(Lqr, HoldingTheInputIncreasesTheCost) {
  const ContinuousLti plant = double_integrator();
  const LqrWeights weights = {diagonal({1, 0}), diagonal({1}), {}};
  const Eigen::MatrixXd S = lqr(plant, weights).X;
  const SampledLqr sampled = sample(plant, weights, 0.3);
  const Eigen::MatrixXd excess = lqr(sampled.plant, sampled.weights).X - S;
  EXPECT_GT(excess.trace(), 0);
  EXPECT_GE(excess.determinant(), 0);
}

TEST(WithIntegrals, AddsNamedStates) {
  const ContinuousLti plant = with_integrals(double_integrator(), {"y"});
  EXPECT_THAT(plant.A,
              MatrixNear((Eigen::MatrixXd(3, 3) << 0, 1, 0, 0, 0, 0, 1, 0, 0).finished(), 0));
  EXPECT_EQ(names(plant.states), "y vy int_y");
  EXPECT_EQ(plant.states[2].unit, "m s");
  const RiccatiResult result =
      lqr(plant, with_integral_weights({diagonal({1, 0}), diagonal({1}), {}}, diagonal({1})));
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_NEAR(result.K(0, 2), 1, 1e-13);  // k_i² r = q_i
}

TEST(WithIntegrals, RefuseUnknownAndRepeatedNames) {
  EXPECT_THAT(
      [] { (void)with_integrals(double_integrator(), {"vz"}); },
      ThrowsMessage<InvalidInput>(HasSubstr("no state 'vz' to integrate, expected one of: y vy")));
  EXPECT_THAT(
      [] {
        (void)with_integrals(double_integrator(), {"y", "y"});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("'y' is listed twice")));
}

// ∫vy = y - y(0): the two cannot be controlled independently.
TEST(Lqr, NamesAnUncontrollableIntegral) {
  const RiccatiResult result = lqr(with_integrals(double_integrator(), {"vy"}),
                                   {Eigen::MatrixXd::Identity(3, 3), diagonal({1}), {}});
  EXPECT_EQ(result.status, RiccatiStatus::not_stabilizable);
  EXPECT_THAT(result.culprit, HasSubstr("y and int_vy cannot be controlled"));
  EXPECT_TRUE(result.K.array().isNaN().all());
}

TEST(Lqr, YawWithoutWeightIsNamed) {
  const RiccatiResult result =
      lqr(discretize_zoh(testing::uquad_hover(), 0.01),
          {diagonal({1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1}), Eigen::MatrixXd::Identity(4, 4), {}});
  EXPECT_EQ(result.status, RiccatiStatus::not_detectable);
  EXPECT_THAT(result.culprit, HasSubstr("theta is not observable through Q"));
}

}  // namespace
}  // namespace quadtune
