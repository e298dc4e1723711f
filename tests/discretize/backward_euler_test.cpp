// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/backward_euler.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"
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

// x[k] = x[k-1] + dt (A x[k] + B u[k]), solved step by step.
TEST(DiscretizeBackwardEuler, TakesTheDerivativeAtTheEndOfTheSample) {
  std::mt19937_64 generator(11);
  const double dt = 0.3;
  const ContinuousLti p = testing::random_plant(4, 2, 3, true, generator);
  const DiscreteLti d = discretize_backward_euler(p, dt);
  const MatrixXd I = MatrixXd::Identity(4, 4);
  VectorXd x = VectorXd::Zero(4);
  VectorXd state = VectorXd::Zero(4);
  for (int k = 0; k < 20; ++k) {
    const VectorXd u = testing::uniform_vector(2, generator);
    x = (I - p.A * dt).inverse() * (x + dt * p.B * u);
    EXPECT_THAT(d.C * state + d.D * u, MatrixRelativelyNear((p.C * x + p.D * u).eval(), 1e-13));
    state = (d.A * state + d.B * u).eval();
  }
}

TEST(DiscretizeBackwardEuler, FirstOrderLagHasItsClosedForm) {
  ContinuousLti p;
  p.A = MatrixXd{{-4}};
  p.B = MatrixXd{{3}};
  const DiscreteLti d = discretize_backward_euler(p, 0.25);
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{0.5}}, 1e-16));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{0.375}}, 1e-16));
  EXPECT_THAT(d.C, MatrixNear(MatrixXd{{0.5}}, 1e-16));
  EXPECT_THAT(d.D, MatrixNear(MatrixXd{{0.375}}, 1e-16));
}

TEST(DiscretizeBackwardEuler, KeepsStabilityAtAnyPeriod) {
  ContinuousLti p;
  p.A = MatrixXd{{-1000, 5}, {0, -0.01}};
  p.B = MatrixXd{{1}, {1}};
  for (const double dt : {1e-4, 1.0, 1e4})
    EXPECT_LT(discretize_backward_euler(p, dt).A.eigenvalues().cwiseAbs().maxCoeff(), 1) << dt;
}

TEST(DiscretizeBackwardEuler, RefusesAPoleThatWouldGoToInfinityAndBadPeriods) {
  ContinuousLti p;
  p.A = MatrixXd{{100}};
  p.B = MatrixXd{{1}};
  EXPECT_THAT([&] { (void)discretize_backward_euler(p, 0.01); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "backward-euler: A has a pole at 100 1/s, expected none at 1/dt because the "
                  "transformation sends it to infinity (dt is 0.01 s); choose another dt")));
  EXPECT_THAT([&] { (void)discretize_backward_euler(p, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("backward-euler: dt is 0 s, expected")));
}

}  // namespace
}  // namespace quadtune
