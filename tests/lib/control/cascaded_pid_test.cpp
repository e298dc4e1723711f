// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/cascaded_pid.hpp"

#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"
#include "quadtune/control/cascade_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune {
namespace {

using Eigen::Vector4d;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

Vehicle mambo() { return load_vehicle("mambo"); }
CascadeGains published() { return mambo().published_cascade->gains; }

CascadedPidSettings<double> settings(PidMethod method = PidMethod::forward_euler,
                                     double attitude_limit = 3, double integrator_limit = 2,
                                     double back_calculation = 0.001) {
  return cascaded_pid_settings(mambo(), published(), method, attitude_limit, integrator_limit,
                               back_calculation);
}

Eigen::VectorXd draw(std::mt19937_64& random, Eigen::Index size) {
  std::uniform_real_distribution<double> between(-1, 1);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return between(random); });
}

// Some samples of a wandering state through the law and through cascade_law(): what they differ by
// is quadratic in the size of the motion.
TEST(CascadedPid, IsTheLinearLawNearHover) {
  std::mt19937_64 random(1);
  for (const PidMethod method :
       {PidMethod::forward_euler, PidMethod::backward_euler, PidMethod::tustin}) {
    const DiscreteLti linear = cascade_law(published(), method);
    const CascadedPidSettings<double> law = settings(method, kNoLimit, kNoLimit, 0);
    std::vector<Eigen::VectorXd> motion(10);
    for (Eigen::VectorXd& point : motion) point = draw(random, 16);
    const auto difference = [&](double size) {
      CascadedPidState<double> state;
      Eigen::VectorXd integrals = Eigen::VectorXd::Zero(linear.A.rows());
      double worst = 0;
      for (const Eigen::VectorXd& now : motion) {
        const Eigen::VectorXd input = size * now;
        Estimate<double> estimate;
        estimate.x = input.tail<12>();
        Reference<double> reference;
        reference.position = input.head<3>();
        reference.yaw = input(3);
        const Vector4d wrench =
            step(law, state, estimate, reference) - Vector4d(law.weight, 0, 0, 0);
        const Eigen::VectorXd want = linear.C * integrals + linear.D * input;
        integrals = linear.A * integrals + linear.B * input;
        worst = std::max(worst, (wrench - want).cwiseAbs().maxCoeff());
      }
      return worst;
    };
    const double coarse = difference(2e-3), fine = difference(1e-3);
    EXPECT_NEAR(coarse / fine, 4, 0.1) << static_cast<int>(method);
    EXPECT_LT(fine, 5e-6);
  }
}

// The error ahead and to the right of the nose: turned by the yaw, a motion gives the same wrench.
TEST(CascadedPid, TurnsPositionErrorsIntoTheHeading) {
  std::mt19937_64 random(2);
  for (const double yaw : {0.5, 2.0, -3.0, 40.0}) {
    CascadedPidState<double> a, b;
    for (int k = 0; k < 5; ++k) {
      Estimate<double> here;
      here.x = 0.2 * draw(random, 12);
      Reference<double> to;
      to.position = draw(random, 3);
      to.yaw = 0.1;
      Estimate<double> there = here;
      Reference<double> turned = to;
      const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      there.x.head<3>() = R * here.x.head<3>();
      there.x(5) += yaw;
      turned.position = R * to.position;
      turned.yaw += yaw;
      EXPECT_THAT(step(settings(), a, here, to),
                  MatrixNear(step(settings(), b, there, turned), 1e-13));
    }
  }
  // A place to the north of a nose that points east is to its left: roll to the left, no pitch.
  CascadedPidState<double> state;
  Estimate<double> estimate;
  estimate.x(5) = std::numbers::pi / 2;
  Reference<double> north;
  north.position = {1, 0, 0};
  north.yaw = estimate.x(5);
  (void)step(settings(), state, estimate, north);
  EXPECT_NEAR(state.roll_reference, -0.24, 1e-15);
  EXPECT_NEAR(state.pitch_reference, 0, 1e-15);
}

TEST(CascadedPid, TakesOffWithConstantThrust) {
  CascadedPidState<double> state;
  Estimate<double> estimate;
  estimate.x << 0.3, -0.2, -0.1, 0.01, 0.02, 0, 0, 0, -0.5, 0, 0, 0;
  Reference<double> reference;
  reference.position = {5, 5, -1.1};
  reference.phase = FlightPhase::take_off;
  for (int k = 0; k < 200; ++k) {
    const Vector4d wrench = step(settings(), state, estimate, reference);
    EXPECT_DOUBLE_EQ(wrench(0), 1.45 * 0.063 * 9.81);
    EXPECT_EQ(state.pitch_reference, 0);
    EXPECT_EQ(state.roll_reference, 0);
    EXPECT_LT(wrench(1), 0);  // and the attitude is held
    EXPECT_LT(wrench(2), 0);
  }
  EXPECT_EQ(state.loops[index_of(CascadeAxis::altitude)].integral, 0);
  EXPECT_EQ(state.loops[index_of(CascadeAxis::x)].output, 0);
  EXPECT_LT(state.loops[index_of(CascadeAxis::roll)].integral, 0);
}

TEST(CascadedPid, FollowsAnAttitudeReference) {
  CascadedPidState<double> state;
  Estimate<double> estimate;
  Reference<double> reference;
  reference.track_position = false;
  reference.position = {100, 100, -2};
  reference.roll = 0.1;
  reference.pitch = -0.2;
  const Vector4d wrench = step(settings(), state, estimate, reference);
  EXPECT_EQ(state.roll_reference, 0.1);
  EXPECT_EQ(state.pitch_reference, -0.2);
  EXPECT_NEAR(wrench(1), 0.01 * 0.1, 1e-15);
  EXPECT_NEAR(wrench(2), 0.013 * -0.2, 1e-15);
  EXPECT_GT(wrench(0), 0.063 * 9.81);  // and the height
}

TEST(CascadedPid, KeepsToItsLimits) {
  const CascadedPidSettings<double> law = settings(PidMethod::forward_euler, 0.3);
  CascadedPidState<double> state;
  Estimate<double> estimate;
  Reference<double> reference;
  reference.position = {-50, 50, -100};
  Vector4d wrench;
  for (int k = 0; k < 2000; ++k) {
    wrench = step(law, state, estimate, reference);
    ASSERT_EQ(state.pitch_reference, 0.3);
    ASSERT_EQ(state.roll_reference, 0.3);
    ASSERT_DOUBLE_EQ(wrench(0), altitude_thrust_limit(mambo()));
  }
  // 2 rad s of error in the integrals: Ki 2 in the outputs.
  EXPECT_LE(state.loops[index_of(CascadeAxis::pitch)].integral, 0.01 * 2);
  reference.position.z() = 100;
  wrench = step(law, state, estimate, reference);
  EXPECT_EQ(wrench(0), 0);
}

// A loop without Ki has no memory: after any time at its limit it is what it was.
TEST(CascadedPid, BackCalculationLeavesLoopsWithoutIntegralAlone) {
  const CascadedPidSettings<double> law = settings(PidMethod::forward_euler, 0.3, 2, 0.1);
  CascadedPidState<double> state;
  Estimate<double> estimate;
  Reference<double> far, home;
  far.position = {100, -100, 0};
  for (int k = 0; k < 4000; ++k) (void)step(law, state, estimate, far);
  (void)step(law, state, estimate, home);
  EXPECT_EQ(state.pitch_reference, 0);
  EXPECT_EQ(state.roll_reference, 0);
  EXPECT_EQ(state.loops[index_of(CascadeAxis::x)].integral, 0);
}

TEST(CascadedPid, RefusesGainsThatCannotRun) {
  CascadeGains gains = published();
  gains.loops[0].Kp = std::nan("");
  EXPECT_THAT([&] { (void)cascaded_pid_settings(mambo(), gains, PidMethod::tustin, 1, 1, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("loop x: Kp is nan")));
  gains = published();
  gains.loops[1].name = "z";
  EXPECT_THROW((void)cascaded_pid_settings(mambo(), gains, PidMethod::tustin, 1, 1, 0),
               InvalidInput);
  EXPECT_THAT(
      [&] { (void)cascaded_pid_settings(mambo(), published(), PidMethod::tustin, 1, 1, 1e4); },
      ThrowsMessage<InvalidInput>(HasSubstr("back_calculation is 10000 1/s, expected 0 to 1/dt")));
}

}  // namespace
}  // namespace quadtune
