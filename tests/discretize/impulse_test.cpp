// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/impulse.hpp"

#include <cmath>
#include <random>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/discretize/matrix_exponential.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

TEST(DiscretizeImpulse, RespondsWithTheSampledImpulseResponse) {
  std::mt19937_64 generator(7);
  const double dt = 0.2;
  const ContinuousLti p = testing::random_plant(5, 2, 3, false, generator);
  const DiscreteLti d = discretize_impulse(p, dt);
  EXPECT_THAT(d.D, MatrixRelativelyNear((dt * p.C * p.B).eval(), 1e-15));
  MatrixXd state = d.B;
  for (int k = 1; k < 20; ++k) {
    const MatrixXd exact = dt * p.C * matrix_exponential(p.A * (k * dt)).E * p.B;
    EXPECT_THAT(d.C * state, MatrixRelativelyNear(exact, 1e-13)) << k;
    state = (d.A * state).eval();
  }
}

TEST(DiscretizeImpulse, FirstOrderLagHasItsClosedForm) {
  ContinuousLti p;
  p.A = MatrixXd{{-3}};
  p.B = MatrixXd{{2}};
  p.inputs = {{"w", "rad/s"}};
  p.states = {{"v", "m/s"}};
  const DiscreteLti d = discretize_impulse(p, 0.1);
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{std::exp(-0.3)}}, 2e-16));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{0.2 * std::exp(-0.3)}}, 1e-16));
  EXPECT_THAT(d.C, MatrixNear(MatrixXd{{1}}, 0));
  EXPECT_THAT(d.D, MatrixNear(MatrixXd{{0.2}}, 1e-16));
  EXPECT_EQ(d.inputs, p.inputs);
  EXPECT_EQ(d.outputs, p.states);
}

TEST(DiscretizeImpulse, RefusesFeedthroughAndBadPeriods) {
  ContinuousLti p;
  p.A = MatrixXd{{1}};
  p.B = MatrixXd{{1}};
  EXPECT_THAT([&] { (void)discretize_impulse(p, -1); },
              ThrowsMessage<InvalidInput>(HasSubstr("impulse: dt is -1 s, expected a positive")));
  EXPECT_THAT([&] { (void)discretize_impulse(p, 1e4); },
              ThrowsMessage<InvalidInput>(HasSubstr("impulse: dt is 10000 s, expected a shorter")));
  p.C = MatrixXd{{1}, {1}};
  p.D = MatrixXd{{0}, {0.5}};
  EXPECT_THAT(
      [&] { (void)discretize_impulse(p, 0.1); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "impulse: D has 0.5 at (2,1), expected 0 because otherwise the impulse response")));
}

}  // namespace
}  // namespace quadtune
