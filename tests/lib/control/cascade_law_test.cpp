// SPDX-License-Identifier: Apache-2.0
/// The linear law against the elements that run on board, and loops around it.
#include "quadtune/control/cascade_law.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using testing::MatrixNear;

CascadeGains some_gains(bool with_integrals) {
  CascadeGains gains;
  gains.dt = 0.005;
  const double Ki = with_integrals ? 1 : 0;
  for (const CascadeAxis axis : kAllCascadeAxes) gains.loops.push_back(cascade_loop(axis));
  const double Kp[] = {-0.24, 0.24, 0.013, 0.01, 0.004, 0.8};
  const double integral[] = {-0.05, 0.04, 0.03, 0.02, 0.005, 0.5};
  const double Kd[] = {0.1, -0.1, -0.002, -0.003, -0.0012, -0.5};
  for (std::size_t i = 0; i < kCascadeAxes; ++i) {
    gains.loops[i].Kp = Kp[i];
    gains.loops[i].Ki = Ki * integral[i];
    gains.loops[i].Kd = Kd[i];
  }
  return gains;
}

/// The six elements one after another, as on board: T, tau_x, tau_y, tau_z.
class Elements {
 public:
  Elements(const CascadeGains& gains, PidMethod method) {
    for (const PidLoop& loop : gains.loops) {
      settings_.push_back(pid_settings(loop, gains.dt));
      settings_.back().method = method;
    }
    states_.resize(settings_.size());
  }

  Eigen::Vector4d step(const Eigen::VectorXd& in) {
    // in: x_sp y_sp z_sp yaw_sp, then px py pz roll pitch yaw u v w p q r
    const auto state = [&](int k) { return in(4 + k); };
    const double pitch_sp = run(CascadeAxis::x, in(0), state(0), state(6));
    const double roll_sp = run(CascadeAxis::y, in(1), state(1), state(7));
    const double tau_y = run(CascadeAxis::pitch, pitch_sp, state(4), state(10));
    const double tau_x = run(CascadeAxis::roll, roll_sp, state(3), state(9));
    const double tau_z = run(CascadeAxis::yaw, in(3), state(5), state(11));
    const double force = run(CascadeAxis::altitude, in(2), state(2), state(8));
    return {-force, tau_x, tau_y, tau_z};
  }

 private:
  double run(CascadeAxis axis, double set_point, double value, double rate) {
    const std::size_t k = index_of(axis);
    return quadtune::step(settings_[k], states_[k], PidInput<double>{set_point, value, rate, 0})
        .value;
  }

  std::vector<PidSettings<double>> settings_;
  std::vector<PidState<double>> states_;
};

TEST(CascadeLaw, IsWhatTheElementsRun) {
  for (const PidMethod method :
       {PidMethod::forward_euler, PidMethod::backward_euler, PidMethod::tustin})
    for (const bool with_integrals : {false, true}) {
      const CascadeGains gains = some_gains(with_integrals);
      const DiscreteLti law = cascade_law(gains, method);
      ASSERT_EQ(law.A.rows(), with_integrals ? 6 : 0);
      Elements elements(gains, method);
      // The trapezoid of the first sample has no sample before it: start at rest.
      elements.step(Eigen::VectorXd::Zero(16));
      Eigen::VectorXd x = Eigen::VectorXd::Zero(law.A.rows());
      std::mt19937 random(7);
      std::normal_distribution<double> normal;
      for (int k = 0; k < 50; ++k) {
        const Eigen::VectorXd in = Eigen::VectorXd::NullaryExpr(16, [&] { return normal(random); });
        const Eigen::Vector4d there = elements.step(in);
        const Eigen::VectorXd here = law.C * x + law.D * in;
        ASSERT_THAT(here, MatrixNear(there, 1e-14))
            << to_string(method) << (with_integrals ? " with" : " without") << " integrals";
        x = (law.A * x + law.B * in).eval();
      }
    }
}

/// The gains with a lead of the rate in three loops.
CascadeGains leading_gains() {
  CascadeGains gains = some_gains(true);
  for (PidLoop& loop : gains.loops) {
    if (loop.name == "yaw") continue;
    loop.rate_lead = loop.name == "x" ? 0.1 : 0.03;
    loop.rate_filter = loop.name == "pitch" ? 0 : 0.008;
  }
  return gains;
}

TEST(CascadeLaw, WithALeadIsWhatTheElementsRun) {
  const CascadeGains gains = leading_gains();
  const DiscreteLti law = cascade_law(gains, PidMethod::tustin);
  ASSERT_EQ(law.A.rows(), 11);
  EXPECT_EQ(law.states[6].name, "rate_x");
  Elements elements(gains, PidMethod::tustin);
  elements.step(Eigen::VectorXd::Zero(16));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(11);
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 50; ++k) {
    const Eigen::VectorXd in = Eigen::VectorXd::NullaryExpr(16, [&] { return normal(random); });
    const Eigen::Vector4d there = elements.step(in);
    ASSERT_THAT(Eigen::VectorXd(law.C * x + law.D * in), MatrixNear(there, 1e-13));
    x = (law.A * x + law.B * in).eval();
  }
}

// Kd (1 + lead s/(Tf s + 1)) from the rate to the torque.
TEST(CascadeLaw, LeadInContinuousTimeIsItsTransferFunction) {
  CascadeGains gains = some_gains(false);
  for (PidLoop& loop : gains.loops)
    if (loop.name == "roll") loop.rate_lead = 0.03, loop.rate_filter = 0.008;
  const ContinuousLti law = cascade_law(gains);
  ASSERT_EQ(law.A.rows(), 1);
  const std::complex<double> s(0.2, 40);
  const std::complex<double> found =
      law.C(1, 0) * law.B(0, kCascadeSetPoints + 9) / (s - law.A(0, 0)) +
      law.D(1, kCascadeSetPoints + 9);
  const double Kd = cascade_law(some_gains(false)).D(1, kCascadeSetPoints + 9);
  EXPECT_LT(std::abs(found - Kd * (1.0 + 0.03 * s / (0.008 * s + 1.0))), 1e-12 * std::abs(found));
}

TEST(CascadeLaw, PushesTheRightWay) {
  const DiscreteLti law = cascade_law(some_gains(false), PidMethod::forward_euler);
  const auto wrench = [&](const std::string& input) {
    Eigen::VectorXd in = Eigen::VectorXd::Zero(16);
    for (std::size_t i = 0; i < law.inputs.size(); ++i)
      if (law.inputs[i].name == input) in(static_cast<Eigen::Index>(i)) = 1;
    return Eigen::Vector4d(law.D * in);
  };
  EXPECT_GT(wrench("pz")(0), 0) << "too low, z being down: more thrust";
  EXPECT_LT(wrench("roll")(1), 0);
  EXPECT_LT(wrench("pitch")(2), 0);
  EXPECT_LT(wrench("yaw")(3), 0);
  EXPECT_LT(wrench("r")(3), 0) << "the rate is damped";
  EXPECT_LT(wrench("x_sp")(2), 0) << "nose down to go forward";
  EXPECT_GT(wrench("y_sp")(1), 0) << "right wing down to go right";
}

TEST(CascadeLaw, ClosesAndCutsOneLoop) {
  // With p = plant and c = law: det(λ - closed) = det(λ - open) det(I + L).
  ContinuousLti plant;
  plant.A = Eigen::MatrixXd::Zero(12, 12);
  plant.A.block(0, 6, 3, 3).setIdentity();
  plant.A.block(3, 9, 3, 3).setIdentity();
  plant.A(6, 4) = -9.81;
  plant.A(7, 3) = 9.81;
  plant.B = Eigen::MatrixXd::Zero(12, 4);
  plant.B(8, 0) = -1 / 0.063;
  plant.B(9, 1) = 1 / 5.8e-5;
  plant.B(10, 2) = 1 / 7.2e-5;
  plant.B(11, 3) = 1e4;
  const ContinuousLti law = cascade_law(some_gains(true));
  const ContinuousLti closed = closed_loop(plant, law);
  const ContinuousLti cut = cut_at_inputs(plant, law);
  const std::complex<double> s(0.3, 2.0);
  const auto characteristic = [&](const Eigen::MatrixXd& A) {
    return (s * Eigen::MatrixXcd::Identity(A.rows(), A.cols()) - A.cast<std::complex<double>>())
        .determinant();
  };
  const Eigen::Index n = cut.A.rows();
  const Eigen::MatrixXcd L =
      cut.C * (s * Eigen::MatrixXcd::Identity(n, n) - cut.A.cast<std::complex<double>>())
                  .partialPivLu()
                  .solve(cut.B.cast<std::complex<double>>());
  const std::complex<double> expected =
      characteristic(cut.A) * (Eigen::Matrix4cd::Identity() + L).determinant();
  EXPECT_LT(std::abs(characteristic(closed.A) - expected), 1e-9 * std::abs(expected));
  EXPECT_EQ(closed.B.cols(), 4);
  EXPECT_EQ(closed.C.rows(), 12);
  // With integrals in all loops each value ends at its set point.
  const Eigen::MatrixXd end = -closed.C * closed.A.partialPivLu().solve(closed.B);
  EXPECT_NEAR(end(0, 0), 1, 1e-9);
  EXPECT_NEAR(end(1, 1), 1, 1e-9);
  EXPECT_NEAR(end(2, 2), 1, 1e-9);
  EXPECT_NEAR(end(5, 3), 1, 1e-9);
}

TEST(CascadeLaw, Refuses) {
  CascadeGains gains = some_gains(true);
  gains.loops[1].name = "z";
  EXPECT_THROW((void)cascade_law(gains), InvalidInput);
  gains = some_gains(true);
  gains.loops[0].Kp = std::nan("");
  EXPECT_THROW((void)cascade_law(gains), InvalidInput);
  gains = some_gains(true);
  gains.dt = 0;
  EXPECT_THROW((void)cascade_law(gains, PidMethod::tustin), InvalidInput);
  gains = leading_gains();
  EXPECT_THROW((void)cascade_law(gains), InvalidInput) << "pitch has no filter";
  gains.loops[0].rate_lead = std::nan("");
  EXPECT_THROW((void)cascade_law(gains, PidMethod::tustin), InvalidInput);
  DiscreteLti plant{
      Eigen::Matrix2d::Identity(), Eigen::Vector2d::Ones(), {}, {}, 0.005, {}, {}, {}};
  EXPECT_THROW((void)closed_loop(plant, cascade_law(some_gains(true), PidMethod::tustin)),
               InvalidInput);
}

}  // namespace
}  // namespace quadtune
