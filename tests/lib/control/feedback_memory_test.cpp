// SPDX-License-Identifier: Apache-2.0
// State feedback that remembers its commands, sees the position in heading axes, and knows limits.
#include <gmock/gmock.h>

#include <cmath>
#include <deque>
#include <numbers>
#include <random>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector4d;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::kNaN;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

MatrixXd draw_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index cols) {
  std::uniform_real_distribution<double> between(-1, 1);
  return MatrixXd::NullaryExpr(rows, cols, [&] { return between(random); });
}

Gains wrench_gains(std::mt19937_64& random, const std::vector<std::string>& integrated) {
  Gains gains;
  gains.states = ned_convention().states;
  gains.inputs = ned_convention().wrench;
  gains.integrals = integral_signals(gains.states, integrated);
  gains.K = draw_matrix(random, 4, 12);
  gains.K_int = draw_matrix(random, 4, std::ssize(gains.integrals));
  gains.x0 = VectorXd::Zero(12);
  gains.u0 = Vector4d(0.6, 0, 0, 0);
  gains.vehicle = "mambo";
  gains.convention = "ned";
  gains.input_kind = InputKind::wrench;
  gains.dt = 0.01;
  return gains;
}

CommandMemory random_memory(std::mt19937_64& random, int past) {
  const Eigen::Index columns = 4 * Eigen::Index{past};
  CommandMemory memory;
  memory.lag = Vector4d(0.02, 0.03, 0.04, 0.05);
  // Small, so that commands that feed back themselves do not grow.
  memory.K_lag = 0.1 * draw_matrix(random, 4, 4);
  memory.past = past;
  memory.K_past = 0.1 * draw_matrix(random, 4, columns);
  return memory;
}

Eigen::Matrix<double, kMaxRotors, 1> input(const VectorXd& u) {
  Eigen::Matrix<double, kMaxRotors, 1> all = Eigen::Matrix<double, kMaxRotors, 1>::Zero();
  all.head(u.size()) = u;
  return all;
}

// The law of CommandMemory's own text, with commands of which the motors produce a part only.
TEST(FeedbackMemory, IsItsFormula) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(1);
  for (const int past : {0, 1, 3}) {
    Gains gains = wrench_gains(random, {"pz"});
    gains.memory = random_memory(random, past);
    const StateFeedbackSettings<double> law = state_feedback_settings(mambo, gains, gains.dt, {});
    StateFeedbackState<double> state;
    VectorXd m = gains.u0;
    std::deque<VectorXd> commands(static_cast<std::size_t>(past), VectorXd(gains.u0));
    double integral = 0;
    for (int k = 0; k < 50; ++k) {
      Estimate<double> estimate;
      estimate.x = draw_matrix(random, 12, 1);
      Reference<double> reference;
      reference.position = draw_matrix(random, 3, 1);
      reference.yaw = 0.3;
      const StateVector<double> error = set_point(law, estimate, reference) - estimate.x;
      integral += gains.dt * error(2);
      VectorXd expected = gains.u0 + gains.K * error + gains.K_int * integral -
                          gains.memory->K_lag * (m - gains.u0);
      for (Eigen::Index j = 0; j < past; ++j)
        expected -= gains.memory->K_past.middleCols(4 * j, 4) *
                    (commands[static_cast<std::size_t>(j)] - gains.u0);
      const auto u = step(law, state, estimate, reference);
      EXPECT_THAT(VectorXd(u.head(4)), MatrixNear(expected, 1e-12)) << past << " " << k;
      const VectorXd made = 0.8 * expected;
      on_realized(law, state, u, input(made));
      const VectorXd arrives = past > 0 ? commands.back() : made;
      for (int i = 0; i < 4; ++i)
        m(i) += (1 - std::exp(-gains.dt / gains.memory->lag(i))) * (arrives(i) - m(i));
      if (past > 0) {
        commands.pop_back();
        commands.push_front(made);
      }
    }
  }
}

// The law in a loop with a linear plant follows the matrices of open_loop(), closed by u = -C z.
TEST(FeedbackMemory, HasTheMatricesOfOpenLoop) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(9);
  for (const int past : {0, 1, 3}) {
    Gains gains = wrench_gains(random, {});
    gains.memory = random_memory(random, past);
    DiscreteLti plant;
    plant.A = 0.2 * draw_matrix(random, 12, 12);
    plant.B = 0.2 * draw_matrix(random, 12, 4);
    plant.C = MatrixXd::Identity(12, 12);
    plant.D = MatrixXd::Zero(12, 4);
    plant.dt = gains.dt;
    plant.states = plant.outputs = gains.states;
    plant.inputs = gains.inputs;
    const DiscreteLti loop = open_loop(plant, gains);
    ASSERT_EQ(loop.A.rows(), 12 + 4 * (1 + past));
    EXPECT_EQ(std::ssize(loop.states), loop.A.rows());
    const StateFeedbackSettings<double> law = state_feedback_settings(mambo, gains, gains.dt, {});
    StateFeedbackState<double> state;
    VectorXd x = draw_matrix(random, 12, 1);
    VectorXd z = VectorXd::Zero(loop.A.rows());
    z.head(12) = x;
    for (int k = 0; k < 30; ++k) {
      Estimate<double> estimate;
      estimate.x = x;
      const auto u = step(law, state, estimate, Reference<double>());
      const VectorXd change = u.head(4) - gains.u0;
      EXPECT_THAT(change, MatrixNear(VectorXd(-loop.C * z), 1e-12)) << past << " " << k;
      on_realized(law, state, u, u);
      x = plant.A * x + plant.B * change;
      z = (loop.A - loop.B * loop.C) * z;
    }
  }
}

// Turned with everything around it, a law in heading axes commands the same.
TEST(FeedbackMemory, DoesNotKnowNorthInHeadingAxes) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(2);
  Gains gains = wrench_gains(random, {"px", "py", "pz"});
  gains.axes = PositionAxes::heading;
  gains.limits.position_error = 0.9;
  const StateFeedbackSettings<double> law = state_feedback_settings(mambo, gains, gains.dt, {});
  for (const double yaw : {0.7, -2.0, 3.1}) {
    StateFeedbackState<double> a, b;
    for (int k = 0; k < 20; ++k) {
      Estimate<double> here, there;
      here.x = 0.5 * draw_matrix(random, 12, 1);
      Reference<double> to;
      to.position = draw_matrix(random, 3, 1);
      to.velocity = draw_matrix(random, 3, 1);
      to.yaw = 0.2;
      there.x = here.x;
      Reference<double> turned = to;
      const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      there.x.head<3>() = R * here.x.head<3>();
      there.x(5) += yaw;
      turned.position = R * to.position;
      turned.velocity = R * to.velocity;
      turned.yaw += yaw;
      EXPECT_THAT(VectorXd(step(law, b, there, turned)),
                  MatrixNear(VectorXd(step(law, a, here, to)), 1e-12));
    }
  }
}

TEST(FeedbackMemory, SeesNoMoreThanItsLimitOfThePositionError) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(3);
  Gains gains = wrench_gains(random, {});
  gains.limits.position_error = 0.5;
  const StateFeedbackSettings<double> law = state_feedback_settings(mambo, gains, gains.dt, {});
  StateFeedbackState<double> state;
  Reference<double> far, near;
  far.position = {30, 40, -1};
  near.position = {0.3, 0.4, -1};  // half a metre in the same direction
  EXPECT_THAT(VectorXd(step(law, state, {}, far)),
              MatrixNear(VectorXd(step(law, state, {}, near)), 1e-12));
  Reference<double> inside;
  inside.position = {0.2, 0.1, -1};
  EXPECT_GT((VectorXd(step(law, state, {}, inside)) - VectorXd(step(law, state, {}, near))).norm(),
            1e-3);
}

// The integral of an error that the motors can no longer act on stands still, and moves at once
// when the error changes its sign.
TEST(FeedbackMemory, DoesNotIntegrateIntoALimit) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(4);
  Gains gains = wrench_gains(random, {"pz"});
  gains.K.setZero();
  gains.K_int << -1, 0, 0, 0;  // a vehicle below its set point, pz > sp, gets more thrust
  gains.limits.conditional_integration = true;
  const StateFeedbackSettings<double> law = state_feedback_settings(mambo, gains, gains.dt, {});
  StateFeedbackState<double> state;
  Estimate<double> below, above;
  below.x(2) = 1;
  above.x(2) = -1;
  Reference<double> ground;
  const double max = 0.65;
  double thrust = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto u = step(law, state, below, ground);
    thrust = u(0);
    auto made = u;
    made(0) = std::min(made(0), max);
    on_realized(law, state, u, made);
  }
  EXPECT_NEAR(thrust, max, 0.02);
  const auto u = step(law, state, above, ground);
  EXPECT_LT(u(0), thrust);
}

// In heading axes the integral of px answers by the column of px along the heading and by that of
// py across it. Facing east, an error to the north is one to the left.
TEST(FeedbackMemory, DoesNotIntegrateIntoALimitAtAnyHeading) {
  const Vehicle mambo = load_vehicle("mambo");
  std::mt19937_64 random(6);
  Gains gains = wrench_gains(random, {"px", "py"});
  gains.K.setZero();
  gains.K_int << 0, 0, 0, 0.1, -0.1, 0, 0, 0;
  gains.axes = PositionAxes::heading;
  gains.limits.conditional_integration = true;
  const StateFeedbackSettings<double> law = state_feedback_settings(mambo, gains, gains.dt, {});
  for (const double yaw : {0.0, 0.5 * std::numbers::pi, 2.0, -2.5}) {
    StateFeedbackState<double> state;
    Estimate<double> here;
    here.x(5) = yaw;
    Reference<double> north;
    north.yaw = yaw;
    north.position = {1, 0, 0};
    const double max = 0.01;
    Eigen::Vector2d torque;
    for (int k = 0; k < 2000; ++k) {
      const auto u = step(law, state, here, north);
      torque = u.segment<2>(1);
      auto made = u;
      made.segment<2>(1) = torque.cwiseMax(-max).cwiseMin(max);
      on_realized(law, state, u, made);
    }
    EXPECT_LT(torque.cwiseAbs().maxCoeff(), max + 0.002) << yaw;
    EXPECT_GT(torque.cwiseAbs().maxCoeff(), 0.99 * max) << yaw;
  }
}

TEST(FeedbackMemory, RefusesWhatItCannotRemember) {
  std::mt19937_64 random(5);
  const auto refusal = [&](auto&& change, const std::string& message) {
    Gains gains = wrench_gains(random, {});
    gains.memory = random_memory(random, 2);
    change(gains);
    EXPECT_THAT([&] { validate(gains, "gains"); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal([](Gains& g) { g.memory->lag(1) = -0.01; }, "lag is -0.01 s, expected more than 0");
  refusal([](Gains& g) { g.memory->lag(1) = kNaN; }, "lag is nan s, expected more than 0");
  refusal([](Gains& g) { g.memory->lag(2) = 1.5; },
          "lag is 1.5 s, expected more than 0, at most 1");
  refusal([](Gains& g) { g.memory->past = 41; }, "past is 41, expected 0 to 40");
  refusal([](Gains& g) { g.memory->K_lag(0, 3) = kNaN; }, "K_lag");
  refusal([](Gains& g) { g.memory->K_past.resize(4, 4); }, "K_past");
  refusal([](Gains& g) { g.dt = 0; }, "dt is 0 s, expected a sample period");
  refusal([](Gains& g) { g.limits.position_error = 0; },
          "the limit of the position error is 0 m, expected more than 0");
}

}  // namespace
}  // namespace quadtune
