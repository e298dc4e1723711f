// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_loop.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "quadtune/errors.hpp"
#include "quadtune/synthesis/margins.hpp"

namespace quadtune {
namespace {

using std::numbers::pi;
using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
constexpr double kDegree = pi / 180;

ContinuousTransferFunction plant(const Eigen::VectorXd& num, const Eigen::VectorXd& den,
                                 double delay = 0) {
  return {num, den, delay};
}

const Eigen::VectorXd kOne = Eigen::VectorXd::Ones(1);

/// 1/(s + 1)³
ContinuousTransferFunction three_lags() { return plant(kOne, Eigen::Vector4d(1, 3, 3, 1)); }

LoopRequirement requirement(PidType type, double crossover, double margin_deg, double Tf = 0) {
  LoopRequirement r;
  r.type = type;
  r.crossover = crossover;
  r.phase_margin = margin_deg * kDegree;
  r.Tf = Tf;
  return r;
}

/// L as one fraction, for loop_margins(), which uses another method.
ContinuousTransferFunction fraction(const ContinuousTransferFunction& P, const PidGains& gains) {
  const Eigen::Vector3d num(gains.Kp * gains.Tf + gains.Kd, gains.Kp + gains.Ki * gains.Tf,
                            gains.Ki);
  const Eigen::Vector3d den(gains.Tf, 1, 0);
  ContinuousTransferFunction L;
  L.delay = P.delay;
  L.num = Eigen::VectorXd::Zero(P.num.size() + 2);
  L.den = Eigen::VectorXd::Zero(P.den.size() + 2);
  for (Eigen::Index i = 0; i < 3; ++i) {
    L.num.segment(i, P.num.size()) += num(i) * P.num;
    L.den.segment(i, P.den.size()) += den(i) * P.den;
  }
  return L;
}

/// Computes the loop independently.
std::complex<double> loop(const ContinuousTransferFunction& P, const PidGains& gains, double w) {
  const std::complex<double> s(0, w);
  return P(s) * (gains.Kp + gains.Ki / s + gains.Kd * s / (gains.Tf * s + 1.0));
}

void expect_meets(const ContinuousTransferFunction& P, const LoopRequirement& r) {
  const PidLoopDesign design = pid_for_crossover(P, r);
  ASSERT_TRUE(design.solved()) << design;
  const std::complex<double> L = loop(P, design.gains, r.crossover);
  EXPECT_NEAR(std::abs(L), 1, 1e-12) << design;
  EXPECT_NEAR(std::arg(-L), r.phase_margin, 1e-12) << design;
  EXPECT_NEAR(design.crossover, r.crossover, 1e-9 * r.crossover);
  EXPECT_NEAR(design.phase_margin, r.phase_margin, 1e-9);
  // |S| at the crossover is 1/(2 sin(margin/2)), a lower bound of Ms.
  EXPECT_GE(design.Ms, 1 / (2 * std::sin(r.phase_margin / 2)) - 1e-12);
}

// An example that control packages print in their manuals: 60 degrees at 0.5205 rad/s.
TEST(PidLoop, PiForThreeLags) {
  const PidLoopDesign design =
      pid_for_crossover(three_lags(), requirement(PidType::PI, 0.5205, 60));
  ASSERT_TRUE(design.solved()) << design;
  EXPECT_NEAR(design.gains.Kp, 1.14, 5e-3);
  EXPECT_NEAR(design.gains.Ki, 0.454, 5e-4);
}

// Closed form for the double integrator: C = e^(j φm) ω² alone, so Kp = ω² cos φm, Kd = ω sin φm.
TEST(PidLoop, PdForADoubleIntegrator) {
  const ContinuousTransferFunction P = plant(kOne, Eigen::Vector3d(1, 0, 0));
  const PidLoopDesign design = pid_for_crossover(P, requirement(PidType::PD, 3, 50));
  ASSERT_TRUE(design.solved()) << design;
  EXPECT_NEAR(design.gains.Kp, 9 * std::cos(50 * kDegree), 1e-12);
  EXPECT_NEAR(design.gains.Kd, 3 * std::sin(50 * kDegree), 1e-12);
}

// 1/s e^(-0.2 s) under P: margin 90° - ω L.
TEST(PidLoop, PForAnIntegratorWithDelay) {
  const ContinuousTransferFunction P = plant(kOne, Eigen::Vector2d(1, 0), 0.2);
  const PidLoopDesign design = pid_for_crossover(P, requirement(PidType::P, 2, 45));
  ASSERT_TRUE(design.solved()) << design;
  EXPECT_NEAR(design.gains.Kp, 2, 1e-12);
  EXPECT_NEAR(design.phase_margin, pi / 2 - 0.4, 1e-9);

  // The maximum feasible crossover has the required margin: ω = (90° - 45°)/L.
  const PidLoopDesign refused = pid_for_crossover(P, requirement(PidType::P, 5, 45));
  EXPECT_EQ(refused.status, PidLoopStatus::phase_infeasible) << refused;
  EXPECT_NEAR(refused.highest_crossover, pi / 4 / 0.2, 1e-5);
  EXPECT_TRUE(std::isnan(refused.gains.Kp));
}

TEST(PidLoop, PidHasADoubleZeroByDefault) {
  for (const double Tf : {0.0, 0.05}) {
    const LoopRequirement r = requirement(PidType::PID, 1.2, 55, Tf);
    expect_meets(three_lags(), r);
    const PidGains gains = pid_for_crossover(three_lags(), r).gains;
    const PidStandard standard = standard_form(gains);
    EXPECT_NEAR(standard.Ti, 4 * standard.Td, 1e-12);
    EXPECT_EQ(gains.Tf, Tf);
  }
}

TEST(PidLoop, GreatestKiEndsAtMs) {
  LoopRequirement r = requirement(PidType::PID, 1.2, 55, 0.05);
  const PidLoopDesign zero = pid_for_crossover(three_lags(), r);
  r.freedom = PidFreedom::max_Ki;
  r.Ms_max = 1.5;
  expect_meets(three_lags(), r);
  const PidLoopDesign design = pid_for_crossover(three_lags(), r);
  EXPECT_GT(design.gains.Ki, 4 * zero.gains.Ki);
  EXPECT_LE(design.Ms, 1.5);
  EXPECT_GT(design.Ms, 1.5 - 1e-6);
}

// Without a limit on Ms, |L| beyond the crossover rises until it touches 1 again; a larger Ki would
// cause a higher crossover. The grid of the search with steps of 3 % resolves the touch to 1e-3.
TEST(PidLoop, GreatestKiEndsWhereAnotherCrossoverWouldAppear) {
  LoopRequirement r = requirement(PidType::PID, 1.2, 55, 0.05);
  r.freedom = PidFreedom::max_Ki;
  const PidGains gains = pid_for_crossover(three_lags(), r).gains;
  double largest = 0;
  for (int k = 0; k < 2000; ++k)
    largest = std::max(largest, std::abs(loop(three_lags(), gains, 1.4 * std::pow(1.001, k))));
  EXPECT_NEAR(largest, 1, 1e-3);

  r.Ms_max = 1.3;
  const PidLoopDesign refused = pid_for_crossover(three_lags(), r);
  EXPECT_EQ(refused.status, PidLoopStatus::Ms_exceeded);
  EXPECT_THAT(refused.culprit, HasSubstr("has max |S| >= 1.45"));
  r.crossover = 0.99 * refused.highest_crossover;
  EXPECT_TRUE(pid_for_crossover(three_lags(), r).solved());
}

// Random plants: solutions meet the requirement in an independently computed loop, and the sign of
// the gains is that of the plant.
TEST(PidLoop, MeetsItsRequirementOnRandomPlants) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  int solved = 0;
  for (int i = 0; i < 60; ++i) {
    Eigen::VectorXcd poles(3);
    for (Eigen::Index k = 0; k < 3; ++k) poles[k] = -std::pow(10, 2 * uniform(random) - 1);
    const double gain = (i % 2 ? 1 : -1) * std::pow(10, 2 * uniform(random) - 1);
    const ContinuousTransferFunction P =
        plant(Eigen::VectorXd::Constant(1, gain), polynomial_of_roots(poles),
              i % 3 ? 0.1 * uniform(random) : 0);
    const PidType type = i % 4 == 0 ? PidType::PI : i % 4 == 1 ? PidType::PD : PidType::PID;
    const LoopRequirement r = requirement(type, std::pow(10, 2 * uniform(random) - 1),
                                          30 + 40 * uniform(random), 0.01 * uniform(random));
    const PidLoopDesign design = pid_for_crossover(P, r);
    if (!design.solved()) {
      EXPECT_THAT(design.culprit, HasSubstr(to_string(type)));
      EXPECT_TRUE(std::isnan(design.gains.Kp));
      continue;
    }
    ++solved;
    expect_meets(P, r);
    if (type == PidType::PID) {
      const LoopMargins margins = loop_margins(OpenLoop(fraction(P, design.gains)));
      EXPECT_TRUE(margins.stable);
      EXPECT_NEAR(margins.Ms, design.Ms, 1e-6 * design.Ms);
      EXPECT_NEAR(margins.Mt, design.Mt, 1e-6 * design.Mt);
      EXPECT_NEAR(margins.phase_margin, design.phase_margin, 1e-6);
    }
    EXPECT_GE(design.gains.Kp * gain, 0);
    EXPECT_GE(design.gains.Ki * gain, 0);
    EXPECT_GE(design.gains.Kd * gain, 0);
  }
  EXPECT_GT(solved, 20);
}

// PI on 1/(s + 1)³: the highest crossover has Ki = 0, where the lags alone leave 60°: 3 atan ω =
// 120°; the lowest has Kp = 0: 3 atan ω = 30°.
TEST(PidLoop, ReportsTheFeasibleCrossovers) {
  const PidLoopDesign high = pid_for_crossover(three_lags(), requirement(PidType::PI, 2, 60));
  EXPECT_EQ(high.status, PidLoopStatus::phase_infeasible);
  EXPECT_NEAR(high.highest_crossover, std::tan(40 * kDegree), 1e-6);
  EXPECT_NEAR(high.lowest_crossover, std::tan(10 * kDegree), 1e-6);
  EXPECT_THAT(high.culprit, StrEq("PI at 2 rad/s must have a phase of 70.3 deg, but its range is "
                                  "-90 to 0; crossovers between 0.1764 and 0.839 rad/s are "
                                  "feasible"));
  for (const double printed : {0.1764, 0.839})
    EXPECT_TRUE(pid_for_crossover(three_lags(), requirement(PidType::PI, printed, 60)).solved());
  const PidLoopDesign low = pid_for_crossover(three_lags(), requirement(PidType::PI, 0.01, 60));
  EXPECT_EQ(low.status, PidLoopStatus::phase_infeasible);
  EXPECT_NEAR(low.lowest_crossover, std::tan(10 * kDegree), 1e-6);
}

// P on 1/(s + 1)³ needs 3 atan ω <= 135°. Low crossovers have any phase margin, because the gain is
// 1 at ω = 0.
TEST(PidLoop, ReportsARangeWithoutALowerEnd) {
  const PidLoopDesign refused = pid_for_crossover(three_lags(), requirement(PidType::P, 5, 45));
  EXPECT_EQ(refused.lowest_crossover, 0) << refused;
  EXPECT_NEAR(refused.highest_crossover, 1, 1e-6);
  EXPECT_THAT(refused.culprit, HasSubstr("crossovers up to"));
  const PidLoopDesign low = pid_for_crossover(three_lags(), requirement(PidType::P, 1e-3, 45));
  EXPECT_TRUE(low.solved()) << low;
}

// A PID without filter adds up to 90°: on e^(-s L)/s² the rest is -180 - ω L + 90 = -180 + margin.
TEST(PidLoop, DelayBoundsTheCrossover) {
  const ContinuousTransferFunction P = plant(kOne, Eigen::Vector3d(1, 0, 0), 0.1);
  const PidLoopDesign design = pid_for_crossover(P, requirement(PidType::PD, 20, 40));
  EXPECT_EQ(design.status, PidLoopStatus::phase_infeasible) << design;
  EXPECT_NEAR(design.highest_crossover, 50 * kDegree / 0.1, 1e-4);
}

TEST(PidLoop, StabilizesAnUnstablePlant) {
  // 1/(s - 1): P with Kp > 1; the crossover ω has Kp = √(1 + ω²) and margin atan ω.
  const ContinuousTransferFunction P = plant(kOne, Eigen::Vector2d(1, -1));
  const PidLoopDesign design = pid_for_crossover(P, requirement(PidType::P, 3, 45));
  ASSERT_TRUE(design.solved()) << design;
  EXPECT_NEAR(design.gains.Kp, std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(design.phase_margin, std::atan(3.0), 1e-9);
  const PidLoopDesign refused = pid_for_crossover(P, requirement(PidType::P, 0.5, 45));
  EXPECT_FALSE(refused.solved());
  EXPECT_NEAR(refused.lowest_crossover, 1, 1e-6);
  EXPECT_TRUE(std::isinf(refused.highest_crossover));
  expect_meets(plant(kOne, Eigen::Vector2d(1, -1), 0.05), requirement(PidType::PI, 3, 45));
}

// A resonance above the crossover exceeds |L| = 1: the gains satisfy only their two equations.
TEST(PidLoop, RefusesALoopWithAnotherCrossover) {
  const double w = 20;
  const double damping = 0.001;
  const ContinuousTransferFunction P =
      plant(Eigen::VectorXd::Constant(1, w * w), Eigen::Vector4d(1, 2 * damping * w, w * w, 0));
  const PidLoopDesign design = pid_for_crossover(P, requirement(PidType::P, 2, 45));
  EXPECT_FALSE(design.solved());
  EXPECT_TRUE(design.status == PidLoopStatus::unstable) << design;
}

TEST(PidLoop, RejectsInvalidRequirements) {
  const auto refusal = [](const LoopRequirement& r, const ContinuousTransferFunction& P) {
    try {
      (void)pid_for_crossover(P, r);
    } catch (const InvalidInput& mistake) {
      return std::string(mistake.what());
    }
    return std::string("accepted");
  };
  const LoopRequirement good = requirement(PidType::PI, 0.5, 60);
  EXPECT_THAT(refusal(good, three_lags()), StrEq("accepted"));
  LoopRequirement r = good;
  r.crossover = std::nan("");
  EXPECT_THAT(refusal(r, three_lags()),
              StrEq("pid_for_crossover: crossover is nan rad/s, expected a positive number"));
  r = good;
  r.phase_margin = 60;
  EXPECT_THAT(refusal(r, three_lags()), HasSubstr("phase margin is 60 rad"));
  r = good;
  r.Tf = -1;
  EXPECT_THAT(refusal(r, three_lags()), HasSubstr("Tf is -1 s"));
  r = good;
  r.Ms_max = 1;
  EXPECT_THAT(refusal(r, three_lags()), HasSubstr("Ms_max is 1"));
  EXPECT_THAT(refusal(good, {}), HasSubstr("num is empty"));
  EXPECT_THAT(refusal(good, plant(Eigen::VectorXd::Zero(1), Eigen::Vector2d(1, 1))),
              HasSubstr("num is 0"));
}

}  // namespace
}  // namespace quadtune
