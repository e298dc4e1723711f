// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/state_feedback_law.hpp"

#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::plus_quadrotor;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

using State = StateVector<double>;

VectorXd draw_vector(std::mt19937_64& random, Eigen::Index size) {
  std::uniform_real_distribution<double> between(-1, 1);
  return VectorXd::NullaryExpr(size, [&] { return between(random); });
}

Gains random_gains(std::mt19937_64& random, const std::string& name, InputKind kind, SignLaw law,
                   int integrals) {
  const Convention& words = convention(name, "test");
  Gains gains;
  gains.convention = name;
  gains.input_kind = kind;
  gains.sign_law = law;
  gains.states = words.states;
  gains.inputs = input_signals(words, kind, 4, "count");
  gains.K = MatrixXd::NullaryExpr(4, 12, [&] { return draw_vector(random, 1)(0); });
  gains.K_int = MatrixXd::NullaryExpr(4, integrals, [&] { return draw_vector(random, 1)(0); });
  for (int j = 0; j < integrals; ++j)
    gains.integrals.push_back(words.states[static_cast<std::size_t>((5 * j + 2) % 12)]);
  gains.x0 = draw_vector(random, 12);
  gains.u0 = draw_vector(random, 4);
  gains.dt = 0.01;
  return gains;
}

constexpr InputKind kKinds[] = {InputKind::rotor_speed, InputKind::rotor_thrust, InputKind::wrench,
                                InputKind::command};
constexpr SignLaw kLaws[] = {SignLaw::set_point_minus_state, SignLaw::state_minus_set_point};

// u = u0 ± (K (sp - x) + K_int ∫(sp - x)), computed in the convention's own words and turned into
// quadtune's at the end.
TEST(StateFeedbackLaw, IsTheFormulaInEveryConvention) {
  std::mt19937_64 random(1);
  for (const Convention& words : conventions())
    for (const InputKind kind : kKinds)
      for (const SignLaw sign : kLaws) {
        const Gains gains = random_gains(random, words.name, kind, sign, 4);
        const StateFeedbackSettings<double> law =
            state_feedback_settings(plus_quadrotor(), gains, 0.01, {});
        StateFeedbackState<double> state;
        VectorXd integral = VectorXd::Zero(4);
        for (int k = 0; k < 5; ++k) {
          Estimate<double> estimate;
          estimate.x = draw_vector(random, 12);
          Reference<double> reference;
          reference.position = draw_vector(random, 3);
          reference.yaw = draw_vector(random, 1)(0);
          const VectorXd u = step(law, state, estimate, reference).head<4>();
          // The set point: the reference's place and yaw, the trim's for the rest.
          State sp_ned = words.from_ned.transpose() * gains.x0;
          sp_ned.head<3>() = reference.position;
          sp_ned(5) = reference.yaw;
          const VectorXd error = words.from_ned * (sp_ned - estimate.x);
          for (int j = 0; j < 4; ++j) integral(j) += 0.01 * error((5 * j + 2) % 12);
          const double s = sign == SignLaw::set_point_minus_state ? 1 : -1;
          const VectorXd theirs = gains.u0 + s * (gains.K * error + gains.K_int * integral);
          const VectorXd ours = input_from_ned(words, kind, 4).transpose() * theirs;
          EXPECT_THAT(u, MatrixNear(ours, 1e-13)) << words.name << " " << to_string(kind);
        }
      }
}

TEST(StateFeedbackLaw, FollowsTheVelocityOfTheReference) {
  std::mt19937_64 random(2);
  Gains gains = random_gains(random, "ned", InputKind::wrench, kLaws[0], 0);
  gains.x0.setZero();
  const StateFeedbackSettings<double> law =
      state_feedback_settings(plus_quadrotor(), gains, 0.01, {});
  Estimate<double> estimate;
  estimate.x << 1, 2, -3, 0.2, -0.1, 0.8, 0, 0, 0, 0, 0, 0;
  Reference<double> reference;
  reference.position = {1, 2, -3};
  reference.velocity = {1, -2, 0.5};
  reference.yaw = 0.8;
  const State sp = set_point(law, estimate, reference);
  const Eigen::Matrix3d R = rotation_of_euler(0.2, -0.1, 0.8);
  EXPECT_THAT(Eigen::Vector3d(sp.segment<3>(6)),
              MatrixNear(Eigen::Vector3d(R.transpose() * reference.velocity), 1e-15));
  EXPECT_EQ(sp(5), 0.8);
}

TEST(StateFeedbackLaw, HoldsAnAttitudeReference) {
  std::mt19937_64 random(3);
  const Gains gains = random_gains(random, "ned", InputKind::wrench, kLaws[0], 0);
  const StateFeedbackSettings<double> law =
      state_feedback_settings(plus_quadrotor(), gains, 0.01, {});
  Estimate<double> estimate;
  estimate.x = draw_vector(random, 12);
  Reference<double> reference;
  reference.track_position = false;
  reference.position = {50, 60, -4};
  reference.roll = 0.1;
  reference.pitch = -0.2;
  reference.yaw = 0.3;
  const State sp = set_point(law, estimate, reference);
  EXPECT_THAT(Eigen::Vector2d(sp.head<2>()), MatrixNear(Eigen::Vector2d(estimate.x.head<2>()), 0));
  EXPECT_THAT(Eigen::Vector2d(sp.segment<2>(6)),
              MatrixNear(Eigen::Vector2d(estimate.x.segment<2>(6)), 0));
  EXPECT_THAT(Eigen::Vector4d(sp.segment<4>(2)),
              MatrixNear(Eigen::Vector4d(-4, 0.1, -0.2, 0.3), 0));
}

// Limits of the last public version of the uquad's program. psi is roll, phi pitch, theta yaw.
TEST(StateFeedbackLaw, GuardsAreThoseOfTheUquad) {
  const auto guard = [](const std::string& state) {
    for (const IntegralGuard& one : uquad_integral_guards())
      if (one.state == state)
        return Eigen::Vector3d(one.error_limit, one.increment_limit, one.integral_limit);
    return Eigen::Vector3d(-1, -1, -1);
  };
  for (const char* tilt : {"psi", "phi"})
    EXPECT_THAT(guard(tilt), MatrixNear(Eigen::Vector3d(0.26, 1e-3, 1), 0)) << tilt;
  EXPECT_THAT(guard("theta"), MatrixNear(Eigen::Vector3d(0.78, 7e-3, 2), 0));
  EXPECT_THAT(guard("z"), MatrixNear(Eigen::Vector3d(2, 2.5e-3, 2), 0));
  for (const char* place : {"x", "y"})
    EXPECT_THAT(guard(place), MatrixNear(Eigen::Vector3d(1, 1, 5), 0)) << place;
}

// An integral stands far off, grows by no more than its increment and stops at its limit, in the
// words of the gains' convention: the uquad's z and theta point the other way.
TEST(StateFeedbackLaw, GuardsItsIntegrals) {
  std::mt19937_64 random(4);
  const Convention& uquad = convention("uquad", "test");
  Gains gains = random_gains(random, "uquad", InputKind::rotor_speed, kLaws[0], 0);
  gains.K.setZero();
  gains.x0.setZero();
  gains.u0.setZero();
  gains.integrals = {{"z", "m s"}, {"theta", "rad s"}};
  gains.K_int = MatrixXd::Zero(4, 2);
  gains.K_int(0, 0) = 1;
  gains.K_int(1, 1) = 1;
  const StateFeedbackSettings<double> law =
      state_feedback_settings(plus_quadrotor(), gains, 0.01, uquad_integral_guards());
  const auto integrals_after = [&](double z, double theta, int samples) -> Eigen::Vector2d {
    StateFeedbackState<double> state;
    State theirs = State::Zero();
    theirs(2) = -z;  // the errors are of a set point at 0
    theirs(5) = -theta;
    Estimate<double> estimate;
    estimate.x = uquad.from_ned.transpose() * theirs;
    Eigen::Vector2d u;
    for (int k = 0; k < samples; ++k) u = step(law, state, estimate, {}).head<2>();
    return u;
  };
  using Two = Eigen::Vector2d;
  EXPECT_THAT(integrals_after(0.1, -0.2, 10), MatrixNear(Two(0.01, -0.02), 1e-15));
  EXPECT_THAT(integrals_after(1, -0.75, 10), MatrixNear(Two(0.025, -0.07), 1e-15));
  EXPECT_THAT(integrals_after(2.1, 0.79, 10), MatrixNear(Two(0, 0), 0));
  EXPECT_THAT(integrals_after(-1, 0.75, 5000), MatrixNear(Two(-2, 2), 1e-15));
}

TEST(StateFeedbackLaw, TakesFewerStates) {
  std::mt19937_64 random(5);
  Gains whole = random_gains(random, "uquad", InputKind::rotor_speed, kLaws[0], 0);
  Gains some = whole;
  some.states = {whole.states[2], whole.states[5], whole.states[9]};
  some.K = MatrixXd(4, 3);
  some.K << whole.K.col(2), whole.K.col(5), whole.K.col(9);
  some.x0 = Eigen::Vector3d(whole.x0(2), whole.x0(5), whole.x0(9));
  for (int j = 0; j < 12; ++j)
    if (j != 2 && j != 5 && j != 9) {
      whole.K.col(j).setZero();
      whole.x0(j) = 0;
    }
  const auto a = state_feedback_settings(plus_quadrotor(), whole, 0.01, {});
  const auto b = state_feedback_settings(plus_quadrotor(), some, 0.01, {});
  EXPECT_THAT(MatrixXd(a.K), MatrixNear(MatrixXd(b.K), 0));
  EXPECT_THAT(VectorXd(a.x0), MatrixNear(VectorXd(b.x0), 0));
}

TEST(StateFeedbackLaw, RefusesGainsOfAnother) {
  std::mt19937_64 random(6);
  const Gains good = random_gains(random, "ned", InputKind::rotor_speed, kLaws[0], 1);
  const auto refusal = [&](const Gains& gains, double dt, const std::string& message,
                           const std::vector<IntegralGuard>& guards = {}) {
    EXPECT_THAT([&] { (void)state_feedback_settings(plus_quadrotor(), gains, dt, guards); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal(good, 0.02,
          "gains: the sample period is 0.01 s, expected 0.02 s, the control period of the law");
  Gains gains = good;
  gains.states[3].name = "bank";
  refusal(gains, 0.01, "gains: no state 'bank' in the convention, expected px py pz");
  gains = good;
  gains.integrals[0].name = "height";
  refusal(gains, 0.01, "gains: no state 'height' in the convention");
  gains = good;
  gains.K = MatrixXd::Zero(3, 12);
  gains.K_int = MatrixXd::Zero(3, 1);
  gains.inputs.pop_back();
  gains.u0 = VectorXd::Zero(3);
  refusal(gains, 0.01, "gains: K has 3 rows, expected 4, one for each input of 'plus'");
  gains = good;
  gains.integrals.assign(13, good.integrals[0]);
  gains.K_int = MatrixXd::Zero(4, 13);
  refusal(gains, 0.01, "gains: 13 integrals, expected at most 12, one for each state");
  refusal(good, 0.01, "integral of 'pz': error_limit is -1, expected 0 or more",
          {{"pz", -1, 1, 1}});
}

}  // namespace
}  // namespace quadtune
