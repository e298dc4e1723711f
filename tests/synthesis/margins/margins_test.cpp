// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/margins.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "margins/disk.hpp"
#include "matrix_near.hpp"
#include "numbers.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/lyapunov.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::kPi;
using ::testing::ThrowsMessage;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

VectorXd coefficients(std::initializer_list<double> values) {
  return VectorXd::Map(values.begin(), static_cast<Eigen::Index>(values.size()));
}

OpenLoop loop(std::initializer_list<double> num, std::initializer_list<double> den,
              double delay = 0) {
  return OpenLoop(ContinuousTransferFunction{coefficients(num), coefficients(den), delay});
}

double decibels(double gain) { return 20 * std::log10(gain); }
double degrees(double angle) { return angle * 180 / kPi; }

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

ContinuousLti random_plant(Eigen::Index n, Eigen::Index m, std::mt19937_64& random) {
  ContinuousLti plant;
  plant.A = random_matrix(n, n, random) / std::sqrt(static_cast<double>(n));
  plant.B = random_matrix(n, m, random);
  return plant;
}

// L(jω) = -24/60 at ω² = 11; 1/|L| = 2.5.
TEST(LoopMargins, ThreePoles) {
  const LoopMargins m = loop_margins(loop({24}, {1, 6, 11, 6}));
  EXPECT_TRUE(m.stable);
  ASSERT_EQ(m.phase_crossovers.size(), 1U);
  EXPECT_NEAR(m.phase_crossovers[0].w, std::sqrt(11.0), 1e-12);
  EXPECT_NEAR(m.gain_margin, 2.5, 1e-12);
  EXPECT_EQ(m.gain_reduction, 0);
  ASSERT_EQ(m.gain_crossovers.size(), 1U);
  EXPECT_NEAR(m.crossover, 2.06, 5e-3);
  EXPECT_NEAR(degrees(m.phase_margin), 35.43, 0.01);
  EXPECT_NEAR(m.delay_margin, m.phase_margin / m.crossover, 1e-15);
}

// Seiler, Packard, Gahinet 2020, section "Disk margins".
TEST(LoopMargins, PublishedDisk) {
  const LoopMargins m = loop_margins(loop({25}, {1, 10, 10, 10}));
  EXPECT_NEAR(m.disk.alpha, 0.4581, 5e-5);
  EXPECT_NEAR(m.disk.w, 1.955, 5e-4);
  EXPECT_NEAR(decibels(m.disk.gain_high), 4.051, 5e-4);
  EXPECT_NEAR(decibels(m.disk.gain_low), -4.051, 5e-4);
  EXPECT_NEAR(degrees(m.disk.phase), 25.80, 5e-3);
  EXPECT_NEAR(decibels(m.gain_margin), 11.13, 5e-3);  // 3.6
}

TEST(LoopMargins, ClosedForms) {
  // 2/(s - 1) is stable for factors above 1/2; |L| = 1 at √3, where arg L is -120°.
  const LoopMargins unstable_plant = loop_margins(loop({2}, {1, -1}));
  EXPECT_TRUE(unstable_plant.stable);
  EXPECT_EQ(unstable_plant.gain_margin, kInfinite);
  EXPECT_NEAR(unstable_plant.gain_reduction, 0.5, 1e-14);
  EXPECT_NEAR(unstable_plant.phase_margin, kPi / 3, 1e-12);
  EXPECT_NEAR(unstable_plant.Mt, 2, 1e-12);
  // An integrator: 90°, π/2 s, |S| ≤ 1.
  const LoopMargins integrator = loop_margins(loop({1}, {1, 0}));
  EXPECT_NEAR(integrator.phase_margin, kPi / 2, 1e-12);
  EXPECT_NEAR(integrator.delay_margin, kPi / 2, 1e-12);
  EXPECT_NEAR(integrator.Ms, 1, 1e-6);
  EXPECT_EQ(integrator.gain_margin, kInfinite);
  // (s - 1)²/s² does not reach -1, and |L| → 1 only as ω → ∞: there is no crossover.
  const LoopMargins small = loop_margins(loop({0.3}, {1, 1}));
  EXPECT_TRUE(small.gain_crossovers.empty());
  EXPECT_EQ(small.phase_margin, kInfinite);
  EXPECT_EQ(small.delay_margin, kInfinite);
}

// k e^(-τs)/s: stable for kτ < π/2.
TEST(LoopMargins, DelayedIntegrator) {
  for (const double delay : {0.01, 0.3, 1.0, 1.5}) {
    const LoopMargins m = loop_margins(loop({1}, {1, 0}, delay));
    EXPECT_TRUE(m.stable);
    EXPECT_NEAR(m.gain_margin, kPi / 2 / delay, 1e-9);
    EXPECT_NEAR(m.delay_margin, kPi / 2 - delay, 1e-12);
  }
  EXPECT_FALSE(loop_margins(loop({1}, {1, 0}, 1.6)).stable);
  EXPECT_FALSE(loop_margins(loop({1}, {1, 0}, 30)).stable);
}

// s² + 1 + e^(-τs)·k: an increasing delay may stabilize and destabilize a loop repeatedly
// (Walton, Marshall 1987).
TEST(LoopMargins, DelayMayStabilize) {
  // L = -0.5/(s² + 0.1 s + 2): crossovers where |2 - ω² + 0.1 jω| = 0.5, so at two frequencies.
  const auto stable = [](double delay) {
    return loop_margins(loop({-0.5}, {1, 0.1, 2}, delay)).stable;
  };
  // By the roots of s² + 0.1 s + 2 - 0.5 e^(-τs) with e^(-τs) by its (8, 8) Padé form.
  const auto by_pade = [](double delay) {
    constexpr int kOrder = 8;
    double c = 1;
    VectorXd up = VectorXd::Zero(kOrder + 1);
    VectorXd down = VectorXd::Zero(kOrder + 1);
    for (int k = 0; k <= kOrder; ++k) {
      down[kOrder - k] = c * std::pow(delay, k);
      up[kOrder - k] = (k % 2 ? -1 : 1) * down[kOrder - k];
      c *= static_cast<double>(kOrder - k) / ((2.0 * kOrder - k) * (k + 1));
    }
    VectorXd closed = VectorXd::Zero(kOrder + 3);
    closed.head(kOrder + 1) += down;
    closed.segment(1, kOrder + 1) += 0.1 * down;
    closed.tail(kOrder + 1) += 2 * down - 0.5 * up;
    return polynomial_roots(closed).real().maxCoeff() < 0;
  };
  int changes = 0;
  bool before = stable(0.05);
  for (int step = 0; step < 63; ++step) {
    const double delay = 0.05 + 0.11 * step;
    const bool here = stable(delay);
    EXPECT_EQ(here, by_pade(delay)) << delay;
    changes += here != before ? 1 : 0;
    before = here;
  }
  EXPECT_GE(changes, 2);
}

// At the margins the poles reach the stability boundary; the eigenvalues are computed independently
// of the frequency response.
TEST(LoopMargins, AreWherePolesReachTheBoundary) {
  std::mt19937_64 random(12);
  int seen_high = 0;
  int seen_low = 0;
  for (int k = 0; k < 60; ++k) {
    const Eigen::Index n = 2 + k % 7;
    const bool discrete = k % 2 == 1;
    const ContinuousLti plant = random_plant(n, 1, random);
    const MatrixXd I = MatrixXd::Identity(n, n);
    DiscreteLti sampled = discretize_zoh(plant, 0.3);
    const LqrWeights weights{I, MatrixXd::Identity(1, 1), {}};
    // A slightly rotated gain for other weights, so that both margins are sometimes finite.
    MatrixXd K = discrete ? lqr(sampled, weights).K : lqr(plant, weights).K;
    K += 0.2 * K.norm() * random_matrix(1, n, random);
    const LoopMargins m =
        loop_margins(discrete ? loop_at_inputs(sampled, K) : loop_at_inputs(plant, K));
    const auto stable = [&](double factor) {
      const MatrixXd closed = discrete ? MatrixXd(sampled.A - factor * sampled.B * K)
                                       : MatrixXd(plant.A - factor * plant.B * K);
      return discrete ? closed.eigenvalues().cwiseAbs().maxCoeff() < 1
                      : closed.eigenvalues().real().maxCoeff() < 0;
    };
    EXPECT_EQ(m.stable, stable(1));
    if (!m.stable) continue;
    for (int i = 1; i < 20; ++i) {
      const double high = std::min(m.gain_margin, 50.0);
      EXPECT_TRUE(stable(m.gain_reduction + (1 - m.gain_reduction) * i / 20));
      EXPECT_TRUE(stable(1 + (high - 1) * i / 20));
    }
    if (m.gain_margin < 50) {
      EXPECT_FALSE(stable(m.gain_margin * (1 + 1e-6)));
      EXPECT_TRUE(stable(m.gain_margin * (1 - 1e-6)));
    }
    if (m.gain_reduction > 0) {
      EXPECT_FALSE(stable(m.gain_reduction * (1 - 1e-6)));
    }
    seen_high += m.gain_margin < 50 ? 1 : 0;
    seen_low += m.gain_reduction > 0 ? 1 : 0;
  }
  EXPECT_GT(seen_high, 10);
  EXPECT_GT(seen_low, 10);
}

// The peaks equal the H∞ norms, which are computed from eigenvalues of a Hamiltonian matrix.
TEST(LoopMargins, PeaksAreNorms) {
  std::mt19937_64 random(31);
  for (int k = 0; k < 30; ++k) {
    const Eigen::Index n = 1 + k % 8;
    const ContinuousLti plant = random_plant(n, 1, random);
    const MatrixXd K = lqr(plant, {MatrixXd::Identity(n, n), MatrixXd::Identity(1, 1), {}}).K +
                       0.1 * random_matrix(1, n, random);
    const LoopMargins m = loop_margins(loop_at_inputs(plant, K));
    if (!m.stable) continue;
    ContinuousLti closed;
    closed.A = plant.A - plant.B * K;
    closed.B = plant.B;
    closed.C = -K;
    closed.D = MatrixXd::Ones(1, 1);
    EXPECT_NEAR(m.Ms / peak_gain(closed).gain, 1, 1e-9) << k;
    closed.D(0, 0) = 0;
    EXPECT_NEAR(m.Mt / peak_gain(closed).gain, 1, 1e-9) << k;
    closed.D(0, 0) = 0.5;
    EXPECT_NEAR(m.disk.alpha * peak_gain(closed).gain, 1, 1e-9) << k;
  }
}

// A resonance so narrow that |L| > 1 only over a ten-thousandth of its frequency.
TEST(LoopMargins, FindsNarrowPeaks) {
  const double zeta = 1e-6;
  const LoopMargins m = loop_margins(loop({1e-4}, {1, 2 * zeta * 3.3, 3.3 * 3.3}));
  ASSERT_EQ(m.gain_crossovers.size(), 2U);
  EXPECT_NEAR(m.gain_crossovers[0].w, 3.3, 1e-4);
  EXPECT_NEAR(m.gain_crossovers[1].w, 3.3, 1e-4);
  EXPECT_NEAR(m.Mt, 1e-4 / (2 * zeta * 3.3 * 3.3), 1e-4 * m.Mt);
}

// k/s² closes to an undamped oscillation at √k, where L is -1 exactly or up to rounding.
TEST(LoopMargins, AnUndampedLoopHasNoFiniteMs) {
  for (const double k : {1.0, 3.0, 4.0, 1e-4}) {
    const LoopMargins m = loop_margins(loop({k}, {1, 0, 0}));
    EXPECT_FALSE(m.stable);
    EXPECT_GT(m.Ms, 1e12) << k;
    EXPECT_GT(m.Mt, 1e12) << k;
    EXPECT_NEAR(m.w_Ms, std::sqrt(k), 1e-9 * std::sqrt(k));
  }
}

// L is -1 at the crossover, and any delay makes the closed loop unstable.
TEST(LoopMargins, AnUndampedLoopHasNoDelayMargin) {
  for (const double k : {0.3, 1.0, 2.0, 3.0, 7.1}) {
    EXPECT_EQ(loop_margins(loop({k}, {1, 0, 0})).delay_margin, 0) << k;
    // k/(s² + 1) closes at √(k + 1), where its L is -1 as well.
    EXPECT_EQ(loop_margins(loop({k}, {1, 0, 1})).delay_margin, 0) << k;
    const LoopMargins delayed = loop_margins(loop({k}, {1, 0, 0}, 1e-3));
    EXPECT_FALSE(delayed.stable) << k;
  }
  for (const double T : {0.1, 1.0, 3.0, 0.7}) {
    // 2/T / (s (s T + 1)²) has L = -1 at 1/T.
    const LoopMargins m = loop_margins(loop({2 / T}, {T * T, 2 * T, 1, 0}));
    EXPECT_EQ(m.delay_margin, 0) << T;
    EXPECT_EQ(m.gain_margin, 1) << T;
    EXPECT_EQ(m.gain_reduction, 1) << T;
    EXPECT_FALSE(loop_margins(loop({2 / T}, {T * T, 2 * T, 1, 0}, 1e-6 * T)).stable) << T;
  }
}

// Anderson, Moore 1990: with a diagonal R, |S| ≤ 1 in the loop of each input.
TEST(LoopMargins, OfLqrAreGuaranteed) {
  std::mt19937_64 random(7);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Index n = 2 + k % 9;
    const Eigen::Index m = 1 + k % 3;
    const ContinuousLti plant = random_plant(n, m, random);
    const MatrixXd root = random_matrix(n, n, random);
    const VectorXd R = (random_matrix(m, 1, random).array().abs() + 0.1).matrix();
    const RiccatiResult design = lqr(plant, {root * root.transpose(), R.asDiagonal(), {}});
    ASSERT_TRUE(design.solved());
    const OpenLoop at_inputs = loop_at_inputs(plant, design.K);
    for (Eigen::Index i = 0; i < m; ++i) {
      const LoopMargins margins = loop_margins(at_inputs.channel(i));
      EXPECT_TRUE(margins.stable);
      EXPECT_LE(margins.Ms, 1 + 1e-6);
      EXPECT_EQ(margins.gain_margin, kInfinite);
      EXPECT_LE(margins.gain_reduction, 0.5 + 1e-9);
      EXPECT_GE(margins.phase_margin, kPi / 3 - 1e-9);
    }
  }
}

// The loop of one input with the others closed, from the equations of the closed plant.
TEST(OpenLoop, ChannelClosesTheOthers) {
  std::mt19937_64 random(17);
  const ContinuousLti plant = random_plant(6, 3, random);
  const MatrixXd K = random_matrix(3, 6, random);
  ContinuousLti with_feed_through = plant;
  with_feed_through.C = K;
  with_feed_through.D = 0.3 * random_matrix(3, 3, random);
  const OpenLoop whole(with_feed_through);
  for (const double w : {0.1, 1.0, 7.0}) {
    const Eigen::MatrixXcd L = whole.at(w);
    for (Eigen::Index i = 0; i < 3; ++i) {
      // 1 + L_i = det(I + L) / det(I + L of the others)
      std::vector<Eigen::Index> others;
      for (Eigen::Index j = 0; j < 3; ++j)
        if (j != i) others.push_back(j);
      const Eigen::MatrixXcd rest =
          Eigen::MatrixXcd::Identity(2, 2) + Eigen::MatrixXcd(L(others, others));
      const Complex expected =
          (Eigen::MatrixXcd::Identity(3, 3) + L).determinant() / rest.determinant() - 1.0;
      EXPECT_LE(std::abs(whole.channel(i).at(w)(0, 0) - expected), 1e-10 * std::abs(expected));
    }
  }
}

TEST(OpenLoop, CutAtInputsOrStatesHasTheSamePoles) {
  std::mt19937_64 random(18);
  const DiscreteLti plant = discretize_zoh(random_plant(4, 2, random), 0.1);
  const MatrixXd K = random_matrix(2, 4, random);
  const OpenLoop inputs = loop_at_inputs(plant, K);
  const OpenLoop states = loop_at_states(plant, K);
  const Eigen::MatrixXcd I2 = Eigen::MatrixXcd::Identity(2, 2);
  const Eigen::MatrixXcd I4 = Eigen::MatrixXcd::Identity(4, 4);
  EXPECT_LE(std::abs((I2 + inputs.at(5)).determinant() - (I4 + states.at(5)).determinant()), 1e-12);
}

// z^-d as states, against the same delay of a held continuous loop by definition.
TEST(LoopMargins, DiscreteDelayIsStates) {
  const VectorXd num = coefficients({0.1});
  const VectorXd den = coefficients({1, -1});
  // 0.1/(z - 1) z^-d: L = -1 at arg z = π/(2d + 1), where |L| = 0.05/sin(ω/2).
  for (const int delay : {0, 1, 2, 7}) {
    const LoopMargins m = loop_margins(OpenLoop(DiscreteTransferFunction{num, den, 0.01, delay}));
    EXPECT_TRUE(m.stable);
    const double angle = kPi / (2 * delay + 1);
    EXPECT_NEAR(m.gain_margin, std::sin(angle / 2) / 0.05, 1e-9 * m.gain_margin) << delay;
  }
}

// Every factor of the disk leaves the loop stable; the worst one on its edge does not.
TEST(DiskMargin, IsAsLargeAsCanBe) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  for (const double skew : {-1.0, 0.0, 0.5, 1.0}) {
    const ContinuousTransferFunction g{coefficients({3, 2}), coefficients({1, 4, 9, 3, 0})};
    const OpenLoop open{g};
    const LoopMargins m = loop_margins(open, skew);
    ASSERT_TRUE(m.stable);
    const auto factor = [&](Complex delta) {
      return (1.0 + 0.5 * (1 - skew) * delta) / (1.0 - 0.5 * (1 + skew) * delta);
    };
    const ContinuousLti plant = realize(g);
    const auto largest_real_part = [&](Complex f) {
      const Eigen::MatrixXcd closed =
          plant.A.cast<Complex>() - f * (plant.B * plant.C).cast<Complex>();
      return closed.eigenvalues().real().maxCoeff();
    };
    for (int k = 0; k < 200; ++k)
      EXPECT_LT(largest_real_part(factor(std::polar(0.999 * m.disk.alpha, angle(random)))), 0);
    const Complex S = 1.0 / (1.0 + open.at(m.disk.w)(0, 0));
    const Complex worst = factor(-1.0 / (S + 0.5 * (skew - 1)) * -1.0);
    EXPECT_LE(std::abs(1.0 + worst * open.at(m.disk.w)(0, 0)), 1e-6);
    EXPECT_NEAR(std::abs(1.0 / (S + 0.5 * (skew - 1))), m.disk.alpha, 1e-12);
    // The ends of the disk are those of the real factors.
    EXPECT_NEAR(factor(m.disk.alpha).real(), m.disk.gain_high, 1e-12);
    EXPECT_NEAR(factor(-m.disk.alpha).real(), m.disk.gain_low, 1e-12);
    // The pure phase change at the edge of the disk: |f| = 1.
    double min = kPi;
    for (int k = 0; k <= 20000; ++k) {
      const Complex f = factor(std::polar(m.disk.alpha, kPi * k / 20000));
      if (std::abs(std::abs(f) - 1) < 1e-4) min = std::min(min, std::abs(std::arg(f)));
    }
    EXPECT_NEAR(m.disk.phase, min, 1e-3) << "skew " << skew;
  }
}

// A resonance above 1 whose phase is past -360 degrees after the delay, or ahead of -180 by lead: L
// reaches -1 with a negative phase change, and the margin of the stable loop is its magnitude.
TEST(LoopMargins, PhaseMarginOfAStableLoopIsPositive) {
  // s/(s² + 0.2 s + 1) · 0.4: |L| > 1 about 1 rad/s, between +90 and -90 degrees.
  const LoopMargins ahead = loop_margins(loop({0.4, 0}, {1, 0.2, 1}));
  ASSERT_TRUE(ahead.stable);
  ASSERT_EQ(ahead.gain_crossovers.size(), 2U);
  EXPECT_LT(ahead.gain_crossovers[0].phase_margin, 0);
  EXPECT_GT(ahead.gain_crossovers[1].phase_margin, 0);
  EXPECT_NEAR(ahead.phase_margin, std::abs(ahead.gain_crossovers[0].phase_margin), 1e-9);
  EXPECT_NEAR(degrees(ahead.phase_margin), 120, 1e-9);  // |L| = 1 where its arg is ∓60 degrees
  // The same with a delay: stable for some delays, where a phase lead moves L to -1.
  std::mt19937_64 random(23);
  std::uniform_real_distribution<double> number(0.05, 6);
  int by_lead = 0;
  const int loops = testing::kSanitized ? 80 : 400;
  for (int k = 0; k < loops; ++k) {
    const double zeta = 0.05 * number(random);
    const LoopMargins m = loop_margins(loop({number(random) * zeta, 0.1 * number(random) * (k % 3)},
                                            {1, 2 * zeta, 1}, number(random)));
    if (!m.stable || m.gain_crossovers.empty()) continue;
    EXPECT_GT(m.phase_margin, 0);
    EXPECT_LE(m.phase_margin, kPi);
    for (const GainCrossover& at : m.gain_crossovers) by_lead += at.phase_margin < 0 ? 1 : 0;
  }
  EXPECT_GT(by_lead, loops / 40);
}

// K (s + 1)²/s³ is stable for K > 1/2 only: the gain margin is a reduction.
TEST(LoopMargins, OfAConditionallyStableLoop) {
  const LoopMargins m = loop_margins(loop({1, 2, 1}, {1, 0, 0, 0}));
  EXPECT_TRUE(m.stable);
  EXPECT_NEAR(m.gain_reduction, 0.5, 1e-12);
  EXPECT_EQ(m.gain_margin, kInfinite);
  EXPECT_GT(m.phase_margin, 0);
  const LoopMargins lost = loop_margins(loop({0.4, 0.8, 0.4}, {1, 0, 0, 0}));
  EXPECT_FALSE(lost.stable);
  EXPECT_LT(lost.phase_margin, 0);
}

// 1/(s + 1)³ · k has the gain margin 8/k for any k, and a gain reduction with an unstable pole.
TEST(LoopMargins, FiniteGainMarginsOfAnySize) {
  for (const double k : {1.0, 1e-5, 1e-6, 1e-9, 1e-15, 1e-30}) {
    const LoopMargins m = loop_margins(loop({k}, {1, 3, 3, 1}));
    EXPECT_NEAR(m.gain_margin * k / 8, 1, 1e-9) << k;
    ASSERT_EQ(m.phase_crossovers.size(), 1U) << k;
    EXPECT_EQ(m.far_phase_crossovers, 0);
  }
  for (const double k : {1e5, 1e8, 1e14}) {  // k (s + 1)²/s³
    const LoopMargins m = loop_margins(loop({k, 2 * k, k}, {1, 0, 0, 0}));
    EXPECT_NEAR(m.gain_reduction * k / 0.5, 1, 1e-9) << k;
  }
  // Discrete: real at Nyquist. 1e-8/(z - 0.5) is -1e-8/1.5 there.
  const LoopMargins nyquist = loop_margins(
      OpenLoop(DiscreteTransferFunction{coefficients({1e-8}), coefficients({1, -0.5}), 0.1, 0}));
  EXPECT_NEAR(nyquist.gain_margin, 1.5e8, 1);
}

// Landmarks of the grid that differ by rounding only: equal axes, repeated poles.
TEST(LoopMargins, AreFoundWithRepeatedPoles) {
  for (const double k : {5.0, 0.3, 44.44444444444444, 8.16326530612245, 400.0})
    for (const int axes : {2, 3, 5}) {
      ContinuousLti plant;
      plant.A = MatrixXd::Zero(axes, axes);
      plant.B = 0.1 * MatrixXd::Identity(axes, axes);
      const OpenLoop all = loop_at_inputs(plant, 10 * k * MatrixXd::Identity(axes, axes));
      for (int i = 0; i < axes; ++i) {
        const LoopMargins m = loop_margins(all.channel(i));
        EXPECT_NEAR(m.crossover, k, 1e-9 * k) << axes;
        EXPECT_NEAR(m.phase_margin, std::numbers::pi / 2, 1e-9);
        EXPECT_NEAR(m.delay_margin * k, std::numbers::pi / 2, 1e-9);
      }
    }
  // L(4j) = -0.0223214285714286.
  EXPECT_NEAR(loop_margins(loop({16, 32}, {1, 15.6, 104, 371.2, 691.2, 512})).gain_margin, 44.8,
              1e-9);
  // L = 4/(s (s + 2)²), with the two poles at -2 equal or one rounding apart.
  for (const double other : {2.0, 2.0000000000000004, 1.9999999999999998}) {
    ContinuousLti plant;
    plant.A = MatrixXd{{0, 1, 0}, {0, -2, 1}, {0, 0, -other}};
    plant.B = MatrixXd{{0}, {0}, {1}};
    const OpenLoop one = loop_at_inputs(plant, MatrixXd{{4, 0, 0}});
    EXPECT_NEAR(loop_margins(one.channel(0)).gain_margin, 4, 1e-9) << other;
  }
}

// The loop 1.1 e^(-sT)/s is stable for T < π/2.2. The two other poles are not observable.
TEST(LoopMargins, DelayMarginIsFoundWithRepeatedPoles) {
  for (const double delay : {1.4, 1.45, 3.636, 10.0}) {
    ContinuousLti plant;
    plant.A = MatrixXd{{0, 0, 0}, {0, -1.0999999999999999, 0}, {0, 0, -1.1000000000000003}};
    plant.B = MatrixXd::Ones(3, 1);
    ContinuousLti late = plant;
    late.C = MatrixXd{{1.1, 0, 0}};
    EXPECT_EQ(loop_margins(OpenLoop(late, delay)).stable, delay < std::numbers::pi / 2.2) << delay;
  }
}

// The rounding of a coefficient determines the sign of L(0) if it is infinite or 0.
TEST(LoopMargins, AtRestAnIntegratorIsNoCrossover) {
  for (const double a : {0.5, 0.6, 0.7, 0.3, 0.1, 0.9}) {
    const DiscreteTransferFunction one{coefficients({0.01}), coefficients({1, -1 - a, a}), 0.1, 0};
    EXPECT_EQ(loop_margins(OpenLoop(one)).gain_reduction, 0) << a;
    const DiscreteTransferFunction two{coefficients({0.01, -0.0099}),
                                       coefficients({1, -2 - a, 1 + 2 * a, -a}), 0.1, 0};
    for (const PhaseCrossover& at : loop_margins(OpenLoop(two)).phase_crossovers)
      EXPECT_GT(at.w, 0) << a;
  }
  const LoopMargins m =
      loop_margins(loop({0.002554917662134099, 0, 4.178117741603894, 0},
                        {1, 875.8397542823259, 70.68769421091422, 15.840839798782413}));
  EXPECT_EQ(m.gain_margin, kInfinite);
}

// e^(-sT) shifts the phase of the loop to -π/2 - wT = -π at w = π/(2 T), far above the pole.
TEST(LoopMargins, GainMarginOfAShortDelay) {
  for (const double delay : {1e-2, 1e-3, 1e-5, 1e-8})
    EXPECT_NEAR(loop_margins(loop({1}, {1, 0}, delay)).gain_margin, std::numbers::pi / (2 * delay),
                1e-6 / delay);
}

// Crossings of the axis that are due to rounding are not margins: loops of relative degree 2 whose
// phase tends to -180 degrees, in any states.
TEST(LoopMargins, RoundingIsNoCrossover) {
  std::mt19937_64 random(29);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Index n = 2 + k % 5;
    ContinuousLti plant = random_plant(n, 1, random);
    plant.A -= 3 * MatrixXd::Identity(n, n);
    // The gain of an LQR has no crossover of the negative axis below 1: infinite margin.
    const RiccatiResult design =
        lqr(plant, {MatrixXd::Identity(n, n), MatrixXd::Identity(1, 1), {}});
    ASSERT_TRUE(design.solved());
    EXPECT_EQ(loop_margins(loop_at_inputs(plant, design.K)).gain_margin, kInfinite) << k;
    // 1/((s + a)(s + b)) in rotated states.
    ContinuousLti second = random_plant(2, 1, random);
    const MatrixXd T = random_matrix(2, 2, random);
    const MatrixXd T_inverse = T.inverse();
    const double a = 0.5 + k, b = 2 + 0.1 * k;
    second.A = T_inverse * (MatrixXd(2, 2) << 0, 1, -a * b, -a - b).finished() * T;
    second.B = T_inverse * Eigen::Vector2d(0, 1);
    second.C = Eigen::RowVector2d(3, 0) * T;
    EXPECT_EQ(loop_margins(OpenLoop(second)).gain_margin, kInfinite) << k;
  }
  // All-pass: |L| = 1 everywhere, and no crossover.
  EXPECT_TRUE(loop_margins(loop({-0.999999, 1}, {1, 1})).gain_crossovers.size() <= 1);
}

// With a delay, a small L keeps crossing the axis: irrelevant crossovers are only counted, the
// margin is listed.
TEST(LoopMargins, CountsOmittedCrossovers) {
  const LoopMargins m = loop_margins(loop({1e-4}, {1, 1}, 1));
  ASSERT_FALSE(m.phase_crossovers.empty());
  EXPECT_GT(m.far_phase_crossovers, 0);
  EXPECT_EQ(m.phase_crossovers.front().gain_margin, m.gain_margin);
  EXPECT_GT(m.gain_margin, 1e4);
  const LoopMargins tiny = loop_margins(loop({1e-9}, {1, 1}, 1));
  EXPECT_NEAR(tiny.gain_margin * 1e-9, m.gain_margin * 1e-4, 1e-9);
  EXPECT_EQ(tiny.phase_crossovers.size(), 1U);
}

TEST(LoopMargins, OneAtRestIsACrossover) {
  const LoopMargins m = loop_margins(loop({1}, {1, 1}));
  ASSERT_EQ(m.gain_crossovers.size(), 1U);
  EXPECT_EQ(m.gain_crossovers[0].w, 0);
  EXPECT_EQ(m.gain_crossovers[0].delay_margin, kInfinite);
}

// e^(jθ) leaves the symmetric disk at 2 tan(θ/2) = α, for α above and below 2; in general at the θ
// for which |δ| = α solves f(δ) = e^(jθ).
TEST(DiskMargin, PhaseAtTheEdgeOfTheDisk) {
  for (const double alpha : {0.3, 1.0, 1.9, 2.0, 2.285, 5.0, 40.0})
    EXPECT_NEAR(internal::disk_of_peak(1 / alpha, 1, 0).phase, 2 * std::atan(alpha / 2), 1e-12);
  for (const double skew : {-1.0, -0.4, 0.3, 1.0, 2.5})
    for (const double alpha : {0.2, 0.9, 1.7, 2.4, 6.0}) {
      const double phase = internal::disk_of_peak(1 / alpha, 1, skew).phase;
      const auto delta = [&](double theta) {
        const Complex f = std::polar(1.0, theta);
        return std::abs((f - 1.0) / (0.5 * (1 - skew) + 0.5 * (1 + skew) * f));
      };
      if (phase < kPi)
        EXPECT_NEAR(delta(phase), alpha, 1e-9) << skew << " " << alpha;
      else
        EXPECT_LE(delta(kPi), alpha * (1 + 1e-12)) << skew << " " << alpha;
    }
}

TEST(LoopMargins, Refusals) {
  std::mt19937_64 random(1);
  const ContinuousLti plant = random_plant(3, 2, random);
  const MatrixXd K = random_matrix(2, 3, random);
  EXPECT_THAT([&] { (void)loop_margins(loop_at_inputs(plant, K)); },
              ThrowsMessage<InvalidInput>(HasSubstr("the loop has 2 channels, expected 1")));
  EXPECT_THAT([&] { (void)loop_at_inputs(plant, K.transpose()); },
              ThrowsMessage<InvalidInput>(HasSubstr("K is 3x2, expected 2x3")));
  EXPECT_THAT([&] { (void)loop_at_inputs(plant, K).channel(2); },
              ThrowsMessage<InvalidInput>(HasSubstr("channel is 2, expected 0 to 1")));
  ContinuousLti wide = plant;
  EXPECT_THAT([&] { OpenLoop open(wide); },
              ThrowsMessage<InvalidInput>(HasSubstr("3 outputs and 2 inputs")));
  wide.C = K;
  EXPECT_THAT([&] { OpenLoop open(wide, 0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr("delay is 0.1 s with 2 channels")));
  wide.D = -MatrixXd::Identity(2, 2);
  EXPECT_THAT([&] { OpenLoop open(wide); },
              ThrowsMessage<InvalidInput>(HasSubstr("I + D is singular")));
  EXPECT_THAT(
      [] {
        (void)loop({1}, {1, 1}, -1);
      },
      ThrowsMessage<InvalidInput>(HasSubstr("delay is -1 s")));
}

}  // namespace
}  // namespace quadtune
