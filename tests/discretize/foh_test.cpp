// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/foh.hpp"

#include <Eigen/LU>
#include <random>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

TEST(DiscretizeFoh, DoubleIntegratorHasItsClosedForm) {
  ContinuousLti p;
  p.A = MatrixXd{{0, 1}, {0, 0}};
  p.B = MatrixXd{{0}, {1}};
  const double dt = 0.2;
  const DiscreteLti d = discretize_foh(p, dt);
  // B₁ = [dt²/6; dt/2], B₀ = [dt²/3; dt/2]
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{1, dt}, {0, 1}}, 1e-17));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{dt * dt}, {dt}}, 1e-16));
  EXPECT_THAT(d.C, MatrixNear(MatrixXd::Identity(2, 2), 0));
  EXPECT_THAT(d.D, MatrixNear(MatrixXd{{dt * dt / 6}, {dt / 2}}, 1e-16));
}

// A thousand short holds in which the input climbs stair by stair, at the mean of each stair.
TEST(DiscretizeFoh, FollowsAnInputThatIsLinearBetweenSamples) {
  std::mt19937_64 generator(3);
  const double dt = 0.3;
  constexpr int kStairs = 1000;
  const ContinuousLti p = testing::random_plant(5, 2, 3, true, generator);
  const DiscreteLti d = discretize_foh(p, dt);
  const DiscreteLti stair = discretize_zoh(p, dt / kStairs);
  VectorXd x = VectorXd::Zero(5);
  VectorXd state = VectorXd::Zero(5);
  VectorXd u = VectorXd::Zero(2);
  for (int k = 0; k < 10; ++k) {
    const VectorXd next = testing::uniform_vector(2, generator);
    state = (d.A * state + d.B * u).eval();
    for (int i = 0; i < kStairs; ++i)
      x = (stair.A * x + stair.B * (u + (i + 0.5) / kStairs * (next - u))).eval();
    u = next;
    EXPECT_THAT(d.C * state + d.D * u, MatrixRelativelyNear((p.C * x + p.D * u).eval(), 1e-6));
  }
}

TEST(DiscretizeFoh, HasThePolesOfTheZeroOrderHoldAndTheGainAtDc) {
  std::mt19937_64 generator(5);
  const ContinuousLti p = testing::random_plant(6, 2, 2, true, generator);
  const DiscreteLti d = discretize_foh(p, 0.1);
  EXPECT_THAT(d.A, MatrixRelativelyNear(discretize_zoh(p, 0.1).A, 1e-15));
  const MatrixXd I = MatrixXd::Identity(6, 6);
  EXPECT_THAT(d.C * (I - d.A).inverse() * d.B + d.D,
              MatrixRelativelyNear((p.D - p.C * p.A.inverse() * p.B).eval(), 1e-12));
}

TEST(DiscretizeFoh, KeepsNamesAndWritesOutWhatWasLeftOut) {
  const ContinuousLti p = testing::uquad_hover();
  const DiscreteLti d = discretize_foh(p, 0.01);
  EXPECT_EQ(d.states, p.states);
  EXPECT_EQ(d.inputs, p.inputs);
  EXPECT_EQ(d.outputs, p.states);
  EXPECT_EQ(d.D.rows(), 12);
  EXPECT_EQ(d.dt, 0.01);
}

TEST(DiscretizeFoh, RefusesBadPeriodsAndPlants) {
  ContinuousLti p;
  p.A = MatrixXd{{1}};
  p.B = MatrixXd{{1}};
  EXPECT_THAT([&] { (void)discretize_foh(p, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("foh: dt is 0 s, expected a positive")));
  EXPECT_THAT([&] { (void)discretize_foh(p, 1e4); },
              ThrowsMessage<InvalidInput>(HasSubstr("foh: dt is 10000 s, expected a shorter")));
  p.B = MatrixXd(2, 1);
  EXPECT_THAT([&] { (void)discretize_foh(p, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("foh: B is 2x1")));
}

}  // namespace
}  // namespace quadtune
