// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/steady_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "numbers.hpp"
#include "quadtune/estimation/kalman_filter.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::kInfinity;
using testing::kNaN;

/// The filter of a height that noise of the acceleration drives, at the variances it settles at.
struct Settled {
  KalmanModel<double, 2, 1> model;
  KalmanState<double, 2> state;
  KalmanFilter steady;

  Settled() {
    model.F << 1, 0.1, 0, 0.9;
    model.G << 0, 0.1;
    model.Q << 0, 0, 0, 0.01;
    constexpr double R = 0.5;
    state.P.setIdentity();
    Eigen::Vector2d M;
    for (int k = 0; k < 3000; ++k) {
      M = state.P.col(0) / (state.P(0, 0) + R);
      (void)update(state, Eigen::RowVector2d(1, 0), 0, R, true);
      predict(model, state, Eigen::Matrix<double, 1, 1>(0));
    }
    steady.model.A = model.F;
    steady.model.B = model.G;
    steady.model.C = MatrixXd{{1, 0}};
    steady.M = M;
    steady.L = model.F * M;
  }
};

TEST(SteadyFilter, IsTheFilterWhoseVariancesHaveSettled) {
  Settled both;
  both.state.x << 2, -1;
  SteadyFilterState<double> steady =
      steady_filter_start<double>(both.steady, VectorXd(both.state.x));
  for (int k = 0; k < 200; ++k) {
    const double y = std::sin(0.1 * k), u = std::cos(0.03 * k);
    const VectorXd estimate = correct<double>(both.steady, steady, VectorXd::Constant(1, y));
    (void)update(both.state, Eigen::RowVector2d(1, 0), y, 0.5, true);
    EXPECT_LT((estimate - both.state.x).norm(), 1e-12) << k;
    predict<double>(both.steady, steady, VectorXd::Constant(1, u));
    predict(both.model, both.state, Eigen::Matrix<double, 1, 1>(u));
    EXPECT_LT((steady.x - both.state.x).norm(), 1e-12) << k;
  }
}

TEST(SteadyFilter, DoesNotUseWhatIsNotFinite) {
  const Settled settled;
  const VectorXd start = Eigen::Vector2d(1, 2);
  const VectorXd one = VectorXd::Constant(1, 1);
  for (const double missing : {kNaN, kInfinity, -kInfinity}) {
    SteadyFilterState<double> state = steady_filter_start<double>(settled.steady, start);
    EXPECT_EQ(correct<double>(settled.steady, state, VectorXd::Constant(1, missing)), start);
    predict<double>(settled.steady, state, VectorXd::Constant(1, missing));
    EXPECT_EQ(state.x, VectorXd(settled.steady.model.A * start)) << missing;
  }
  // An innovation is used once.
  SteadyFilterState<double> state = steady_filter_start<double>(settled.steady, start);
  (void)correct<double>(settled.steady, state, VectorXd::Constant(1, 5));
  predict<double>(settled.steady, state, one);
  const VectorXd x = state.x;
  predict<double>(settled.steady, state, one);
  EXPECT_LT((state.x - (settled.steady.model.A * x + settled.steady.model.B * one)).norm(), 1e-15);
}

}  // namespace
}  // namespace quadtune
