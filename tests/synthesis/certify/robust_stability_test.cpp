// SPDX-License-Identifier: Apache-2.0 The stability boundary of each box is known in closed form:
// the proof must almost reach it and never exceed it.
#include "quadtune/synthesis/robust_stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "certify/contraction.hpp"
#include "certify/enclosed_loop.hpp"
#include "margins/loop_parts.hpp"
#include "quadtune/errors.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;

/// u[k] = -K x[k] for a plant with one parameter, a factor of B.
UncertainLoop static_loop(const MatrixXd& A, const MatrixXd& B, const MatrixXd& K, double dt) {
  UncertainLoop loop;
  loop.plant.A = A;
  loop.plant.B = MatrixXd::Zero(B.rows(), B.cols());
  loop.terms = {{"gain", {}, B}};
  loop.law.A = MatrixXd(0, 0);
  loop.law.B = MatrixXd(0, A.rows());
  loop.law.C = MatrixXd(B.cols(), 0);
  loop.law.D = -K;
  loop.law.dt = dt;
  return loop;
}

LoopBox gains(double low, double high, double delay_low = 0, double delay_high = 0) {
  return {VectorXd::Constant(1, low), VectorXd::Constant(1, high), delay_low, delay_high};
}

/// x' = θ u, u = -x once per second: without delay, 1 - θ is the only pole.
UncertainLoop integrator() {
  return static_loop(MatrixXd::Zero(1, 1), MatrixXd::Ones(1, 1), MatrixXd::Ones(1, 1), 1);
}

StabilityProofStatus status(const UncertainLoop& loop, const LoopBox& box) {
  return prove_stability(loop, box).status;
}

// The proof needs many boxes, so that threads share the work.
TEST(ProveStability, DoesNotDependOnTheThreads) {
  const MatrixXd A = (MatrixXd(3, 3) << 0, 1, 0, 0, 0, 1, 0, 0, -8).finished();
  const MatrixXd B = (MatrixXd(3, 1) << 0, 0, 8).finished();
  UncertainLoop loop = static_loop(A, B, (MatrixXd(1, 3) << 4, 4, 0.4).finished(), 0.05);
  loop.terms.push_back({"lag", (MatrixXd(3, 3) << 0, 0, 0, 0, 0, 0, 0, 0, -1).finished(), B / 8});
  LoopBox box{Eigen::Vector2d(0.6, -3), Eigen::Vector2d(1.6, 4), 0, 0.06};
  StabilityProofOptions options;
  options.threads = 1;
  const StabilityProof alone = prove_stability(loop, box, options);
  EXPECT_EQ(alone.status, StabilityProofStatus::proved) << alone.culprit;
  EXPECT_GT(alone.boxes, 30);
  for (const std::size_t threads : {2, 5}) {
    options.threads = threads;
    const StabilityProof shared = prove_stability(loop, box, options);
    EXPECT_EQ(shared.status, alone.status);
    EXPECT_EQ(shared.boxes, alone.boxes);
    EXPECT_EQ(shared.proved_boxes, alone.proved_boxes);
    EXPECT_EQ(shared.gap, alone.gap);
  }
  // The number of boxes is the same, and so is the box that is not proved.
  options.max_boxes = 21;
  options.threads = 1;
  const StabilityProof few = prove_stability(loop, box, options);
  options.threads = 3;
  const StabilityProof few_shared = prove_stability(loop, box, options);
  EXPECT_EQ(few.status, StabilityProofStatus::not_proved);
  EXPECT_EQ(few.boxes, 21);
  EXPECT_EQ(few_shared.boxes, 21);
  EXPECT_EQ(few_shared.where.low, few.where.low);
  EXPECT_EQ(few_shared.culprit, few.culprit);
  // Only a proof that would exceed the budget by far is aborted early.
  options.max_boxes = 2000;
  options.abort_factor = 1;
  EXPECT_EQ(prove_stability(loop, box, options).boxes, alone.boxes);
  options.abort_factor = 0.01;
  box.delay_high = 0.05;  // with one past output everywhere: 128 boxes are enough to tell
  const StabilityProof given_up = prove_stability(loop, box, options);
  EXPECT_EQ(given_up.status, StabilityProofStatus::not_proved);
  EXPECT_LT(given_up.boxes, 150);
  EXPECT_THAT(given_up.culprit, HasSubstr("of the box is proved"));
}

// z = 1 - θ.
TEST(ProveStability, ReachesTheMaximumGainOfAnIntegrator) {
  EXPECT_EQ(status(integrator(), gains(1e-6, 2 - 1e-6)), StabilityProofStatus::proved);
  EXPECT_NE(status(integrator(), gains(1e-6, 2)), StabilityProofStatus::proved);
  EXPECT_NE(status(integrator(), gains(0, 1)), StabilityProofStatus::proved);
}

// A double integrator with both poles at a for θ = 1. The eigenvectors of such a loop are parallel;
// the basis of a cluster of eigenvalues proves the box around it at once.
TEST(ProveStability, ProvesADoublePoleInOneBox) {
  for (const double a : {0.5, 0.8, 0.95}) {
    const double position = (1 - a) * (1 - a);
    const Eigen::RowVector2d K(position, 2 * (1 - a) - position / 2);
    const UncertainLoop loop = static_loop((MatrixXd(2, 2) << 0, 1, 0, 0).finished(),
                                           (MatrixXd(2, 1) << 0, 1).finished(), K, 1);
    const StabilityProof proof = prove_stability(loop, gains(1 - 0.001, 1 + 0.001));
    EXPECT_EQ(proof.status, StabilityProofStatus::proved) << a << proof.culprit;
    EXPECT_EQ(proof.boxes, 1) << a;
  }
}

// z^(m+1) - z^m + θ = 0 with a delay of m periods is stable for 0 < θ < 2 sin(π/(2(2m+1))), and a
// shorter delay permits a larger gain.
TEST(ProveStability, ReachesTheMaximumGainWithDelay) {
  for (const int m : {1, 2, 5}) {
    const double max = 2 * std::sin(std::numbers::pi / (2 * (2 * m + 1)));
    EXPECT_EQ(status(integrator(), gains(0.2 * max, 0.995 * max, 0, m)),
              StabilityProofStatus::proved)
        << m;
    EXPECT_EQ(status(integrator(), gains(0.2 * max, 0.9999 * max, m, m)),
              StabilityProofStatus::proved)
        << m;
    EXPECT_NE(status(integrator(), gains(0.2 * max, 1.0001 * max, m, m)),
              StabilityProofStatus::proved)
        << m;
    EXPECT_NE(status(integrator(), gains(0.2 * max, 1.001 * max, 0, m)),
              StabilityProofStatus::proved)
        << m;
  }
}

// A delay of φ < 1 period: z² - (1 - θ(1-φ)) z + θ φ, stable for θ < 1/φ and θ < 2/(1-2φ).
TEST(ProveStability, HandlesFractionsOfAPeriod) {
  for (const double delay : {0.25, 0.5, 0.8}) {
    const double max = std::min(1 / delay, delay < 0.5 ? 2 / (1 - 2 * delay) : 1e9);
    EXPECT_EQ(status(integrator(), gains(0.1, max - 1e-4, delay, delay)),
              StabilityProofStatus::proved)
        << delay;
    EXPECT_NE(status(integrator(), gains(0.1, max + 1e-4, delay, delay)),
              StabilityProofStatus::proved)
        << delay;
  }
}

// With a fixed gain, the maximum delay is to be found: θ = 1 tolerates one period.
TEST(ProveStability, ReachesTheMaximumDelayOfAGain) {
  EXPECT_EQ(status(integrator(), gains(1, 1, 0, 0.999)), StabilityProofStatus::proved);
  EXPECT_NE(status(integrator(), gains(1, 1, 0, 1.001)), StabilityProofStatus::proved);
}

// x' = -θ x + u, u = -K x: z = e^(-θ dt) - K (1 - e^(-θ dt))/θ, whose minimum θ is the worst.
TEST(ProveStability, BoundsTheExponentialOfAnUncertainPole) {
  UncertainLoop loop =
      static_loop(MatrixXd::Zero(1, 1), MatrixXd::Zero(1, 1), MatrixXd::Constant(1, 1, 3), 0.5);
  loop.plant.B.setOnes();
  loop.terms = {{"pole", MatrixXd::Constant(1, 1, -1), {}}};
  const auto pole = [](double a) { return std::exp(-a / 2) - 3 * (1 - std::exp(-a / 2)) / a; };
  double low = -10;  // z rises from there to 0 and beyond
  double high = 3;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (std::abs(pole(middle)) < 1 ? high : low) = middle;
  }
  ASSERT_NEAR(std::abs(pole(high)), 1, 1e-9);
  EXPECT_EQ(status(loop, gains(high + 1e-4, 20)), StabilityProofStatus::proved);
  EXPECT_NE(status(loop, gains(high - 1e-4, 20)), StabilityProofStatus::proved);
}

// A double integrator under position and rate feedback, sampled: Jury's conditions in θ.
TEST(ProveStability, ReachesJurysConditionsOfADoubleIntegrator) {
  const double dt = 0.1;
  const double kp = 4;
  const double kd = 3;
  const UncertainLoop loop =
      static_loop((MatrixXd(2, 2) << 0, 1, 0, 0).finished(), (MatrixXd(2, 1) << 0, 1).finished(),
                  (MatrixXd(1, 2) << kp, kd).finished(), dt);
  // z² - (2 - θ(kp dt²/2 + kd dt)) z + 1 + θ(kp dt²/2 - kd dt): 4 > 2 θ kd dt.
  const double max = 2 / (kd * dt);
  EXPECT_EQ(status(loop, gains(0.05, 0.9999 * max)), StabilityProofStatus::proved);
  EXPECT_NE(status(loop, gains(0.05, 1.0001 * max)), StabilityProofStatus::proved);
}

// No point of a dense search may contradict the proof of a random loop.
TEST(ProveStability, NeverProvesAnUnstableLoop) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  int proved = 0;
  int denied = 0;
  const int trials = testing::kSanitized ? 18 : 60;
  for (int trial = 0; trial < trials; ++trial) {
    const int nx = 1 + trial % 3;
    const auto draw = [&](int rows, int cols) {
      return MatrixXd(MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); }));
    };
    UncertainLoop loop;
    loop.plant.A = draw(nx, nx) - 0.5 * MatrixXd::Identity(nx, nx);
    loop.plant.B = draw(nx, 1);
    loop.terms = {{"a", draw(nx, nx), {}}, {"b", {}, draw(nx, 1)}};
    loop.law.A = MatrixXd::Constant(1, 1, 0.3);
    loop.law.B = 0.3 * draw(1, nx);
    loop.law.C = draw(1, 1);
    loop.law.D = 0.5 * draw(1, nx);
    loop.law.dt = 0.3;
    const double wide = 0.6 * uniform(random);
    const LoopBox box{VectorXd::Constant(2, -wide), VectorXd::Constant(2, wide), 0,
                      0.5 * uniform(random)};
    StabilityProofOptions options;
    options.max_boxes = 3000;
    const StabilityProof proof = prove_stability(loop, box, options);
    double worst = 0;
    for (int i = 0; i <= 10; ++i)
      for (int j = 0; j <= 10; ++j)
        for (int k = 0; k <= 6; ++k) {
          const VectorXd numbers =
              (VectorXd(2) << wide * (i / 5.0 - 1), wide * (j / 5.0 - 1)).finished();
          worst = std::max(worst, spectral_radius(loop, numbers, box.delay_high * k / 6));
        }
    proved += proof.proved() ? 1 : 0;
    denied += worst >= 1 ? 1 : 0;
    EXPECT_FALSE(proof.proved() && worst >= 1) << trial << ": " << worst;
    EXPECT_TRUE(proof.proved() || worst >= 0.98) << trial << ": " << worst << proof.culprit;
    // The norms contract by the gap, so that no |pole| exceeds 1 - gap.
    EXPECT_FALSE(proof.proved() && worst > 1 - proof.gap + 1e-9) << trial;
  }
  EXPECT_GE(proved, trials / 6);
  EXPECT_GE(denied, trials / 6);
}

// Two decoupled loops are proved separately, also if they are coupled by 1e-14.
TEST(ProveStability, BoundsTheCouplingByRounding) {
  UncertainLoop loop =
      static_loop(MatrixXd::Zero(2, 2), MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2), 1);
  for (const double coupling : {0.0, 1e-14}) {
    loop.law.D(0, 1) = coupling;
    const StabilityProof proof = prove_stability(loop, gains(0.1, 1.9));
    EXPECT_TRUE(proof.proved()) << proof.culprit;
    EXPECT_EQ(proof.parts.size(), 2);
    EXPECT_GE(proof.coupling, coupling);
    EXPECT_LT(proof.coupling, 1e-9);
  }
}

// The coupling is too weak to merge the parts, but too strong for two slow poles: they are proved
// as one loop.
TEST(ProveStability, MergesPartsWithSignificantCoupling) {
  UncertainLoop loop = static_loop(MatrixXd::Zero(2, 2), MatrixXd::Identity(2, 2),
                                   1e-11 * MatrixXd::Identity(2, 2), 1);
  loop.plant.A << 0, 0, 1, -5;  // something larger in the same rows
  loop.law.D(0, 1) = 1e-13;
  loop.law.D(1, 0) = 1e-13;
  const StabilityProof proof = prove_stability(loop, gains(1, 1));
  EXPECT_NE(proof.status, StabilityProofStatus::unstable) << proof.culprit;
}

/// x' = θ J x + growth x rotates by θ per period; u removes 0.9 of the first state per period on
/// average.
UncertainLoop turning(double growth = 0.01) {
  UncertainLoop loop = static_loop(MatrixXd::Zero(2, 2), (MatrixXd(2, 1) << 1, 0).finished(),
                                   (MatrixXd(1, 2) << 0.9, 0).finished(), 1);
  loop.plant.A = growth * MatrixXd::Identity(2, 2);
  loop.plant.B = loop.terms[0].B;
  loop.terms = {{"turn", (MatrixXd(2, 2) << 0, 1, -1, 0).finished(), {}}};
  return loop;
}

// Stable at both corners and at the midpoint, where the interpolation is even smaller, but not at
// θ = 0.
TEST(ProveStability, DetectsInstabilityBetweenTheCorners) {
  const UncertainLoop loop = turning();
  for (const double turn : {-0.6, 0.6, 1.8})
    EXPECT_LT(spectral_radius(loop, VectorXd::Constant(1, turn), 0), 1);
  EXPECT_GT(spectral_radius(loop, VectorXd::Zero(1), 0), 1);
  EXPECT_NE(status(loop, gains(-0.6, 1.8)), StabilityProofStatus::proved);
  EXPECT_EQ(status(loop, gains(0.3, 1.2)), StabilityProofStatus::proved);
}

// Unstable only close to θ = 0, away from the corners and the midpoint: only the interpolation
// error reveals it.
TEST(ProveContraction, IncludesTheInterpolationError) {
  const UncertainLoop loop = turning(1e-5);
  for (const double turn : {-0.05, 0.02, 0.09})
    ASSERT_LT(spectral_radius(loop, VectorXd::Constant(1, turn), 0), 1);
  ASSERT_GT(spectral_radius(loop, VectorXd::Zero(1), 0), 1);
  const internal::EnclosedBox box{VectorXd::Constant(1, -0.05), VectorXd::Constant(1, 0.09), 0, 0,
                                  0};
  EXPECT_FALSE(internal::prove_contraction(loop, box).proved);
}

// Both sources of nonlinearity, a parameter of A and a fraction of the period: the loop deviates
// from the interpolation by at most the error bound.
TEST(InterpolationError, BoundsTheLoopBetweenTheCorners) {
  const UncertainLoop loop = turning();
  for (const int past : {0, 1, 3}) {
    const internal::EnclosedBox box{VectorXd::Constant(1, 0.2), VectorXd::Constant(1, 0.8), 0.1,
                                    0.9, past};
    const std::vector<MatrixXd> errors = internal::interpolation_errors(loop, box);
    ASSERT_EQ(errors.size(), 2);
    const MatrixXd R = errors[0] + errors[1];
    const auto at = [&](double s, double t) {
      return internal::enclosed_loop(loop, VectorXd::Constant(1, 0.2 + 0.6 * s), 0.1 + 0.8 * t,
                                     past)
          .mid;
    };
    double closest = 0;
    for (const double s : {0.1, 0.5, 0.8})
      for (const double t : {0.2, 0.5, 0.9}) {
        const MatrixXd between =
            (1 - s) * ((1 - t) * at(0, 0) + t * at(0, 1)) + s * ((1 - t) * at(1, 0) + t * at(1, 1));
        const MatrixXd off = (at(s, t) - between).cwiseAbs();
        EXPECT_TRUE((off.array() <= R.array() + 1e-15).all()) << past << "\n" << off << "\n\n" << R;
        closest = std::max(closest, off.maxCoeff() / R.maxCoeff());
      }
    EXPECT_GT(closest, 0.1);  // a bound, and not a wall
  }
}

// x' = (θ J - 0.1) x + u, u = 10 x, over two turns a period between the corners: all four look
// alike to a proof that does not bend, and are not: z = e^(iθ - 0.1) + 10 (e^(iθ - 0.1) - 1)/(iθ -
// 0.1).
TEST(ProveContraction, DetectsWholeRotationsBetweenTheCorners) {
  UncertainLoop loop = static_loop(-0.1 * MatrixXd::Identity(2, 2), MatrixXd::Zero(2, 2),
                                   -10 * MatrixXd::Identity(2, 2), 1);
  loop.plant.B.setIdentity();
  loop.terms = {{"turn", (MatrixXd(2, 2) << 0, -1, 1, 0).finished(), {}}};
  const double turn = 2 * std::numbers::pi;
  for (const double turns : {5.0, 6.0, 7.0})
    ASSERT_LT(spectral_radius(loop, VectorXd::Constant(1, turns * turn), 0), 1);
  ASSERT_GT(spectral_radius(loop, VectorXd::Constant(1, 5.5 * turn), 0), 1.05);
  const internal::EnclosedBox box{VectorXd::Constant(1, 5 * turn), VectorXd::Constant(1, 7 * turn),
                                  0, 0, 0};
  EXPECT_FALSE(internal::prove_contraction(loop, box).proved);
  EXPECT_EQ(status(loop, gains(5 * turn, 7 * turn)), StabilityProofStatus::unstable);
}

/// Two parts with one state, one memory and one input each, which `joined` couples in every matrix,
/// or in all except those between the states of the plant.
UncertainLoop two_parts(double joined, bool states) {
  const MatrixXd pattern = (MatrixXd(2, 2) << 1, joined, -joined, 0.8).finished();
  const MatrixXd between_states = states ? pattern : MatrixXd(pattern.diagonal().asDiagonal());
  UncertainLoop loop = static_loop(-1.5 * between_states, 0.7 * pattern, 0.4 * pattern, 0.5);
  loop.plant.B = pattern;
  loop.terms.push_back({"pole", 0.3 * between_states, {}});
  loop.law.A = 0.2 * pattern;
  loop.law.B = 0.6 * pattern;
  loop.law.C = -0.3 * pattern;
  return loop;
}

// The effect of a part on itself through the other part is within its bound, and of second order.
TEST(DetourSize, BoundsPathsThroughAnotherPart) {
  for (const auto& [past, states] :
       {std::pair{0, true}, {0, false}, {1, true}, {1, false}, {3, true}}) {
    const internal::EnclosedBox box{VectorXd::Constant(2, -0.5), VectorXd::Constant(2, 0.5), 0.1,
                                    0.4, past};
    const std::vector<internal::LoopPart> parts = internal::loop_parts(two_parts(0, states), box);
    ASSERT_EQ(parts.size(), 2);
    std::vector<double> largest;
    for (const double joined : {0.3, 0.03}) {
      const UncertainLoop loop = two_parts(joined, states);
      const MatrixXd bound = internal::detour_size(loop, box, internal::part_numbers(loop, parts));
      double closest = 0;
      for (const double theta : {-0.5, 0.1, 0.5})
        for (const double ahead : {0.1, 0.3, 0.4})
          for (const internal::LoopPart& part : parts) {
            const std::vector<Eigen::Index> at = part.places(loop, past);
            const VectorXd numbers = VectorXd::Constant(2, theta);
            const MatrixXd whole = internal::enclosed_loop(loop, numbers, ahead, past).mid(at, at);
            const MatrixXd off =
                whole - internal::enclosed_loop(part.loop, numbers, ahead, past).mid;
            EXPECT_TRUE((off.cwiseAbs().array() <= bound(at, at).array() + 1e-15).all()) << off;
            closest = std::max(closest, off.cwiseAbs().maxCoeff() / bound(at, at).maxCoeff());
          }
      EXPECT_GT(closest, 0.03);
      largest.push_back(bound.diagonal().maxCoeff());
    }
    EXPECT_NEAR(largest[1] / largest[0], 0.01, 0.003);
  }
}

// A pole that is at 1 for all values of the parameters.
TEST(ProveStability, DoesNotProveAnOpenLoopIntegrator) {
  UncertainLoop loop = integrator();
  loop.law.D.setZero();
  EXPECT_NE(status(loop, gains(0.5, 1.5)), StabilityProofStatus::proved);
}

TEST(ProveStability, ReportsWhereItStopped) {
  const StabilityProof unstable = prove_stability(integrator(), gains(0.5, 3));
  EXPECT_EQ(unstable.status, StabilityProofStatus::unstable);
  EXPECT_THAT(unstable.culprit, HasSubstr("spectral radius"));
  EXPECT_EQ(unstable.numbers, std::vector<std::string>{"gain"});
  EXPECT_GT(0.5 * (unstable.where.low(0) + unstable.where.high(0)), 1.99);
  StabilityProofOptions few;
  few.max_boxes = 3;
  const StabilityProof stopped = prove_stability(integrator(), gains(0.01, 0.99, 0, 1), few);
  EXPECT_EQ(stopped.status, StabilityProofStatus::not_proved);
  EXPECT_THAT(stopped.culprit, HasSubstr("3 parts of the box were examined"));
  EXPECT_TRUE(std::isnan(stopped.gap));
  few.interrupted = [] { return true; };
  EXPECT_EQ(prove_stability(integrator(), gains(0.5, 1), few).status,
            StabilityProofStatus::interrupted);
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(ProveStability, RejectsInvalidBoxes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      refusal([&] { (void)prove_stability(integrator(), gains(2, 1)); }),
      HasSubstr("prove_stability: gain is in 2 … 1, expected finite bounds in increasing order"));
  EXPECT_THAT(refusal([&] { (void)prove_stability(integrator(), gains(nan, 1)); }),
              HasSubstr("gain is in nan"));
  EXPECT_THAT(refusal([&] { (void)prove_stability(integrator(), gains(1, 1, 0.2, 0.1)); }),
              HasSubstr("the delay is in 0.2 … 0.1 s"));
  EXPECT_THAT(refusal([&] { (void)prove_stability(integrator(), gains(1, 1, 0, 41)); }),
              HasSubstr("from 0 to 40 periods of 1 s"));
  UncertainLoop loop = integrator();
  loop.law.dt = 0;
  EXPECT_THAT(refusal([&] { (void)prove_stability(loop, gains(1, 1)); }),
              HasSubstr("the law's dt is 0 s, expected more than 0"));
  loop = integrator();
  loop.law.D = MatrixXd::Zero(2, 1);
  EXPECT_THAT(refusal([&] { (void)prove_stability(loop, gains(1, 1)); }),
              HasSubstr("the law's D is 2x1, expected 1x1"));
}

}  // namespace
}  // namespace quadtune
