// SPDX-License-Identifier: Apache-2.0 The linear law used for margins and synthesis equals the
// on-board law.
#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/synthesis/flown_plant.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::MatrixNear;

MatrixXd draw(std::mt19937_64& random, Eigen::Index rows, Eigen::Index cols) {
  std::uniform_real_distribution<double> between(-1, 1);
  return MatrixXd::NullaryExpr(rows, cols, [&] { return between(random); });
}

Gains random_gains(std::mt19937_64& random, int past) {
  Gains gains;
  gains.states = ned_convention().states;
  gains.inputs = ned_convention().wrench;
  gains.integrals = integral_signals(gains.states, {"px", "pz", "yaw"});
  gains.K = draw(random, 4, 12);
  gains.K_int = draw(random, 4, 3);
  gains.x0 = VectorXd::Zero(12);
  gains.u0 = Eigen::Vector4d(0.6, 0, 0, 0);
  gains.vehicle = "mambo";
  gains.convention = "ned";
  gains.input_kind = InputKind::wrench;
  gains.dt = 0.005;
  gains.memory = CommandMemory{Eigen::Vector4d(0.02, 0.03, 0.05, 0.08), 0.1 * draw(random, 4, 4),
                               past, 0.1 * draw(random, 4, Eigen::Index{4} * past)};
  return gains;
}

TEST(FlownLaw, EqualsTheOnBoardLaw) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(1);
  for (const int past : {0, 1, 4}) {
    const Gains gains = random_gains(random, past);
    const DiscreteLti law = flown_law(mambo, gains, gains.dt);
    const StateFeedbackSettings<double> settings =
        state_feedback_settings(mambo, gains, gains.dt, {});
    StateFeedbackState<double> state;
    VectorXd x = VectorXd::Zero(law.A.rows());
    for (int k = 0; k < 60; ++k) {
      Estimate<double> estimate;
      estimate.x = 0.1 * draw(random, 12, 1);
      const Reference<double> origin;
      const auto u = step(settings, state, estimate, origin);
      on_realized(settings, state, u, u);
      const VectorXd linear = law.C * x + law.D * estimate.x;
      EXPECT_THAT(VectorXd(u.head(4) - gains.u0), MatrixNear(linear, 1e-12)) << past << " " << k;
      x = (law.A * x + law.B * estimate.x).eval();
    }
  }
}

}  // namespace
}  // namespace quadtune
