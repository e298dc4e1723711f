// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/cascade_loop.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
constexpr double kDt = 0.005;

/// value'' = b command, sampled.
CascadePlant double_integrator(double b, double lag = 0) {
  const Eigen::Index n = lag > 0 ? 3 : 2;
  ContinuousLti plant;
  plant.A = Eigen::MatrixXd::Zero(n, n);
  plant.A(0, 1) = 1;
  plant.B = Eigen::MatrixXd::Zero(n, 1);
  if (lag > 0) {
    plant.A(1, 2) = b;
    plant.A(2, 2) = -1 / lag;
    plant.B(2, 0) = 1 / lag;
  } else {
    plant.B(1, 0) = b;
  }
  plant.C = Eigen::MatrixXd::Identity(2, n);
  plant.D = Eigen::MatrixXd::Zero(2, 1);
  return discretize_zoh(plant, kDt);
}

// Kd b T/(z - 1), with z - 1 = 2j sin(wT/2) e^(jwT/2): |S| is largest at Nyquist, 2/(2 - Kd b T),
// and |L| = 1 at (2/T) asin(Kd b T/2).
TEST(CascadeLoop, RateLoopOfAnIntegratorMatchesClosedForm) {
  const double a = 60;
  const CascadePlant plant = double_integrator(1e4);
  const CascadeLoopEvidence evidence =
      cascade_loop_evidence(plant, {1e-9, 0, a / 1e4, 0}, PidMethod::forward_euler);
  EXPECT_NEAR(evidence.rate.Ms, 2 / (2 - a * kDt), 1e-9);
  EXPECT_NEAR(evidence.rate.crossover, 2 / kDt * std::asin(a * kDt / 2), 1e-7);
  EXPECT_NEAR(evidence.rate_noise, a / 1e4 * 2 / (2 - a * kDt), 1e-9);

  // The inverse problem: a rate loop alone with Ms = 1.4.
  const CascadeLoopDesign design =
      design_cascade_loop(plant, {.rate_crossover = 200}, PidMethod::forward_euler);
  EXPECT_EQ(design.status, CascadeLoopStatus::crossover_infeasible);
  EXPECT_NEAR(design.highest_rate_crossover, 2 / kDt * std::asin(1 - 1 / 1.4), 1e-6);
  EXPECT_THAT(design.culprit, HasSubstr("expected less than 115.9"));
}

TEST(CascadeLoop, LoadResponseMatchesClosedForm) {
  const CascadePlant plant = double_integrator(1e4);
  // Without integral the steady-state value is 1/Kp, and a damped loop does not overshoot it.
  const CascadeLoopEvidence stiff =
      cascade_loop_evidence(plant, {0.004, 0, 0.0012, 0}, PidMethod::forward_euler);
  EXPECT_NEAR(stiff.load_steady_state, 250, 1e-6);
  EXPECT_NEAR(stiff.load_peak, 250, 0.01);
  EXPECT_TRUE(std::isinf(stiff.load_integral));
  EXPECT_NEAR(stiff.tracking_peak, 1, 1e-3);

  // With an integral, the sum of the value over the samples is 1/Ki.
  const PidGains gains{0.004, 0.005, 0.0012, 0};
  const CascadeLoopEvidence integral =
      cascade_loop_evidence(plant, gains, PidMethod::forward_euler);
  EXPECT_EQ(integral.load_steady_state, 0);
  CascadePlant closed = closed_at_command(plant, gains, PidMethod::forward_euler);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(closed.A.rows());
  load.head(2) = plant.B;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(closed.A.rows());
  double sum = 0;
  double peak = 0;
  for (int k = 0; k < 20000; ++k) {
    x = (closed.A * x + load).eval();
    sum += closed.C.row(0).dot(x) * kDt;
    peak = std::max(peak, std::abs(closed.C.row(0).dot(x)));
  }
  EXPECT_NEAR(sum, integral.load_integral, 1e-6 * sum);
  EXPECT_NEAR(peak, integral.load_peak, 1e-9 * peak);
}

TEST(CascadeLoop, OpenLoopYieldsTheClosedLoopPoles) {
  const CascadePlant plant = double_integrator(1e4, 0.02);
  const PidGains gains{0.004, 0.005, 0.0012, 0};
  for (const PidMethod method :
       {PidMethod::forward_euler, PidMethod::backward_euler, PidMethod::tustin}) {
    const OpenLoop cut(cut_at_command(plant, gains, method));
    const Eigen::VectorXcd poles = cut.closed_loop_poles();
    const Eigen::MatrixXd A = closed_at_command(plant, gains, method).A;
    for (const std::complex<double> pole : poles) {
      const Eigen::MatrixXcd M = pole * Eigen::MatrixXcd::Identity(A.rows(), A.cols()) - A;
      EXPECT_LT(std::abs(M.determinant()), 1e-10) << pole;
    }
  }
}

struct Wanted {
  CascadeLoopBounds bounds;
  double b;
  double lag;
};

/// Loops with different speeds, with and without lag, and with all kinds of bounds.
std::vector<Wanted> wanted() {
  std::vector<Wanted> all;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(0, 1);
  for (int k = 0; k < 12; ++k) {
    Wanted one;
    one.b = std::pow(10, 6 * u(random) - 1);
    one.lag = k % 2 == 0 ? 0 : 0.01 + 0.05 * u(random);
    one.bounds.Ms_max = 1.1 + 0.7 * u(random);
    one.bounds.tracking_max = 1.05 + 0.4 * u(random);
    one.bounds.rate_crossover_max = 10 + 40 * u(random);
    if (k % 3 == 0) one.bounds.value_noise_max = 200 * u(random) / one.b;
    if (k % 4 == 0) one.bounds.rate_noise_max = 20 * u(random) / one.b;
    one.bounds.integral = k % 5 != 4;
    all.push_back(one);
  }
  return all;
}

bool kept(const CascadeLoopBounds& bounds, const CascadeLoopEvidence& e, double slack) {
  return e.margins.stable && e.margins.Ms <= bounds.Ms_max * (1 + slack) &&
         e.tracking_peak <= bounds.tracking_max * (1 + slack) &&
         e.value_noise <= bounds.value_noise_max * (1 + slack) &&
         e.rate_noise <= bounds.rate_noise_max * (1 + slack) &&
         e.rate.crossover <= bounds.rate_crossover_max * (1 + slack);
}

TEST(CascadeLoop, MeetsItsBoundsAndIsLocallyOptimal) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Wanted& one : wanted()) {
    const CascadePlant plant = double_integrator(one.b, one.lag);
    const CascadeLoopDesign design =
        design_cascade_loop(plant, one.bounds, PidMethod::forward_euler);
    ASSERT_TRUE(design.solved()) << design;
    EXPECT_TRUE(kept(one.bounds, design.evidence, 1e-6)) << design;
    EXPECT_FALSE(design.binding.empty());
    EXPECT_EQ(design.gains.Ki != 0, one.bounds.integral);
    const double best = one.bounds.integral ? design.gains.Ki : design.gains.Kp;
    for (int k = 0; k < 60; ++k) {
      PidGains other = design.gains;
      const double width = std::pow(10.0, -1 - k % 3);
      other.Kp *= std::exp(width * normal(random));
      other.Kd *= std::exp(width * normal(random));
      (one.bounds.integral ? other.Ki : other.Kp) = best * 1.003;
      EXPECT_FALSE(
          kept(one.bounds, cascade_loop_evidence(plant, other, PidMethod::forward_euler), 0))
          << design << "\n"
          << other;
    }
  }
}

TEST(CascadeLoop, MeetsTheBandwidthExactly) {
  const CascadePlant plant = double_integrator(1e4);
  const CascadeLoopDesign design =
      design_cascade_loop(plant, {.rate_crossover = 40}, PidMethod::tustin);
  ASSERT_TRUE(design.solved()) << design;
  EXPECT_NEAR(design.evidence.rate.crossover, 40, 1e-6);
}

TEST(CascadeLoop, BoundsTheLoadPeak) {
  const CascadePlant plant = double_integrator(1 / 7.16914e-5);
  const CascadeLoopEvidence there =
      cascade_loop_evidence(plant, {0.013, 0.01, 0.002, 0}, PidMethod::forward_euler);
  CascadeLoopBounds bounds;
  bounds.Ms_max = there.margins.Ms;
  bounds.tracking_max = 1.15;
  bounds.value_noise_max = there.value_noise;
  bounds.rate_noise_max = there.rate_noise;
  bounds.load_peak_max = 0.97 * there.load_peak;
  const CascadeLoopDesign design = design_cascade_loop(plant, bounds, PidMethod::forward_euler);
  ASSERT_TRUE(design.solved()) << design;
  EXPECT_LE(design.evidence.load_peak, bounds.load_peak_max);
  EXPECT_GT(design.gains.Ki, 0.015);
  EXPECT_THAT(design.binding, Contains("value noise"));
  bounds.load_peak_max = 0.5 * there.load_peak;  // at that noise: no
  EXPECT_EQ(design_cascade_loop(plant, bounds, PidMethod::forward_euler).status,
            CascadeLoopStatus::not_found);
}

TEST(CascadeLoop, Refuses) {
  const CascadePlant plant = double_integrator(1e4);
  const auto said = [&](const CascadeLoopBounds& bounds) -> std::string {
    try {
      (void)design_cascade_loop(plant, bounds, PidMethod::forward_euler);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(said({.rate_crossover = 700}), HasSubstr("less than pi/dt = 628.319"));
  EXPECT_THAT(said({.rate_crossover = -1}), HasSubstr("more than 0"));
  EXPECT_THAT(said({.Ms_max = 1}), HasSubstr("more than 1"));
  EXPECT_THAT(said({.tracking_max = std::nan("")}), HasSubstr("more than 1"));
  EXPECT_THAT(said({.rate_noise_max = 0}), HasSubstr("not positive"));
  CascadePlant one_output = plant;
  one_output.C = plant.C.topRows(1);
  one_output.D = plant.D.topRows(1);
  EXPECT_THROW((void)design_cascade_loop(one_output, CascadeLoopBounds{}, PidMethod::forward_euler),
               InvalidInput);
  CascadePlant algebraic = plant;
  algebraic.D(0, 0) = 1;
  EXPECT_THROW((void)cascade_loop_evidence(algebraic, {1, 0, 1, 0}, PidMethod::forward_euler),
               InvalidInput);
}

}  // namespace
}  // namespace quadtune
