// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matched.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

VectorXd list(std::initializer_list<double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.begin(), static_cast<Eigen::Index>(numbers.size()));
}

// (s + 1)/((s + 2)(s + 3)(s + 5)): two zeros at infinity, one of which is mapped to -1.
TEST(DiscretizeMatched, MapsPolesZerosAndTheGainAtDc) {
  const double dt = 0.1;
  const ContinuousTransferFunction p{list({1, 1}), list({1, 10, 31, 30})};
  const DiscreteTransferFunction d = discretize_matched(p, dt);
  const Eigen::Vector2cd zeros(std::exp(-0.1), -1);
  const Eigen::Vector3cd poles(std::exp(-0.2), std::exp(-0.3), std::exp(-0.5));
  EXPECT_THAT(d.den, MatrixNear(polynomial_of_roots(poles), 1e-14));
  EXPECT_THAT(d.num / d.num[0], MatrixNear(polynomial_of_roots(zeros), 1e-14));
  EXPECT_NEAR(d(1).real(), 1.0 / 30, 1e-14);
}

TEST(DiscretizeMatched, KeepsAllZerosOfAPlantWithFeedthrough) {
  const DiscreteTransferFunction d =
      discretize_matched(ContinuousTransferFunction{list({2, 4}), list({1, 5})}, 0.1);
  const double gain = 0.8 * (1 - std::exp(-0.5)) / (1 - std::exp(-0.2));
  EXPECT_THAT(d.num, MatrixNear(list({gain, -gain * std::exp(-0.2)}), 1e-14));
}

// With n poles at 0, sⁿ G(s) at s → 0 is what ((z - 1)/dt)ⁿ G_d(z) is at z → 1.
TEST(DiscretizeMatched, KeepsTheGainOfIntegratorsAtLowFrequency) {
  const DiscreteTransferFunction one =
      discretize_matched(ContinuousTransferFunction{list({1}), list({1, 0})}, 0.1);
  EXPECT_THAT(one.num, MatrixNear(list({0.1}), 1e-16));
  EXPECT_THAT(one.den, MatrixNear(list({1, -1}), 0));
  for (const double dt : {1e-4, 0.1, 2.0}) {
    // (s + 3)/(s² (s + 2)): (z - 1)² G_d → 3/2 dt² = gain (1 - e^(-3 dt)) 2/(1 - e^(-2 dt)).
    const ContinuousTransferFunction p{list({1, 3}), list({1, 2, 0, 0})};
    const DiscreteTransferFunction d = discretize_matched(p, dt);
    const double gain = 0.75 * dt * dt * std::expm1(-2 * dt) / std::expm1(-3 * dt);
    EXPECT_NEAR(d.num[0] / gain, 1, 1e-13) << dt;
    // Far below the sampling frequency the two are the same.
    const double w = 1e-3 / dt;
    const std::complex<double> ratio = d(std::polar(1.0, w * dt)) / p(std::complex<double>(0, w));
    EXPECT_NEAR(std::abs(ratio), 1, 1e-3) << dt;
  }
}

// A zero at 0 is a pole there the other way round: G/s and G_d dt/(z - 1).
TEST(DiscretizeMatched, KeepsTheSlopeOfDifferentiatorsAtLowFrequency) {
  for (const double dt : {0.01, 0.3}) {
    const ContinuousTransferFunction p{list({1, 0}), list({1, 2, 10})};
    const DiscreteTransferFunction d = discretize_matched(p, dt);
    EXPECT_EQ(d.num.sum(), 0);
    EXPECT_NEAR(d.num[0] / d.den.sum(), 0.1 / dt, 1e-12 / dt);
  }
}

// Neither a pole nor a zero near 0 makes the gain jump: the low-frequency gain is continuous.
TEST(DiscretizeMatched, AlmostAnIntegratorIsAlmostTheSame) {
  const double dt = 0.05;
  const double integrator =
      discretize_matched(ContinuousTransferFunction{list({1}), list({1, 3, 0})}, dt).num[0];
  for (const double pole : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const ContinuousTransferFunction p{list({1}), list({1, 3 + pole, 3 * pole})};
    EXPECT_NEAR(discretize_matched(p, dt).num[0] / integrator, 1, pole) << pole;
  }
}

// The same plants as matrices, an integrator chain turned so that rounding scatters its poles too.
TEST(DiscretizeMatched, StateSpaceOfIntegratorsIsTheSame) {
  const double dt = 0.02;
  const MatrixXd turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  ContinuousLti p;  // (2 s + 1)/s³
  p.A = turn * MatrixXd{{0, 1, 0}, {0, 0, 1}, {0, 0, 0}} * turn.transpose();
  p.B = turn * Eigen::Vector3d(0, 0, 1);
  p.C = Eigen::RowVector3d(1, 2, 0) * turn.transpose();
  const DiscreteLti d = discretize_matched(p, dt);
  const DiscreteTransferFunction want =
      discretize_matched(ContinuousTransferFunction{list({2, 1}), list({1, 0, 0, 0})}, dt);
  for (const double w : {1.0, 10.0, 100.0}) {
    const std::complex<double> z = std::polar(1.0, w * dt);
    const Eigen::MatrixXcd zI = z * Eigen::MatrixXcd::Identity(3, 3);
    const std::complex<double> got =
        (d.C.cast<std::complex<double>>() *
         (zI - d.A).partialPivLu().solve(d.B.cast<std::complex<double>>()))
            .value() +
        d.D(0, 0);
    EXPECT_LT(std::abs(got / want(z) - 1.0), 1e-4) << w;
  }
  // A differentiator with a lag, s/(s + 4): (z - 1)/(z - e^(-4 dt)) times (1 - e^(-4 dt))/(4 dt).
  ContinuousLti q;
  q.A = MatrixXd{{-4}};
  q.B = MatrixXd{{1}};
  q.C = MatrixXd{{-4}};
  q.D = MatrixXd{{1}};
  const DiscreteLti slope = discretize_matched(q, dt);
  EXPECT_NEAR(slope.D(0, 0), -std::expm1(-4 * dt) / (4 * dt), 1e-13);
}

// Poles ±2πi/dt come to z = 1, where an integrator's is.
TEST(DiscretizeMatched, RefusesModesOfWholeTurns) {
  const double w = 2 * M_PI / 0.1;
  EXPECT_THAT(
      [&] {
        (void)discretize_matched(ContinuousTransferFunction{list({1}), list({1, 0, w * w})}, 0.1);
      },
      ThrowsMessage<InvalidInput>(HasSubstr("a mode of 62.8319 rad/s completes whole cycles")));
}

TEST(DiscretizeMatched, StateSpaceIsTheSamePlant) {
  ContinuousLti p;
  p.A = MatrixXd{{0, 1, 0}, {-10, -2, 1}, {0, 0, -4}};
  p.B = MatrixXd{{0}, {1}, {3}};
  p.C = MatrixXd{{1, 0.5, 0}};
  p.D = MatrixXd{{0.25}};
  p.inputs = {{"w", "rad/s"}};
  p.outputs = {{"z", "m"}};
  const double dt = 0.05;
  const DiscreteLti d = discretize_matched(p, dt);
  EXPECT_EQ(d.A.rows(), 3);
  EXPECT_EQ(d.inputs, p.inputs);
  EXPECT_EQ(d.outputs, p.outputs);
  EXPECT_TRUE(d.states.empty());
  // By the numerator det(sI - A + B C/D) D and the denominator det(sI - A).
  ContinuousTransferFunction same;
  same.den = polynomial_of_roots(p.A.eigenvalues());
  same.num = polynomial_of_roots((p.A - p.B * p.C / 0.25).eigenvalues(), 0.25);
  const DiscreteTransferFunction want = discretize_matched(same, dt);
  for (const double w : {0.1, 3.0, 40.0}) {
    const std::complex<double> z = std::exp(std::complex<double>(0, w * dt));
    const Eigen::MatrixXcd zI = z * Eigen::MatrixXcd::Identity(3, 3);
    const std::complex<double> got =
        (d.C.cast<std::complex<double>>() *
         (zI - d.A).partialPivLu().solve(d.B.cast<std::complex<double>>()))
            .value() +
        d.D(0, 0);
    EXPECT_LT(std::abs(got - want(z)), 1e-11 * std::abs(want(z)));
  }
}

TEST(DiscretizeMatched, NothingStaysNothing) {
  const DiscreteTransferFunction d =
      discretize_matched(ContinuousTransferFunction{list({0, 0}), list({1, 5})}, 0.1);
  EXPECT_EQ(d(0.3), std::complex<double>(0));
}

TEST(DiscretizeMatched, RefusesMoreThanOneChannel) {
  ContinuousLti p;
  p.A = MatrixXd{{-1, 0}, {0, -2}};
  p.B = MatrixXd{{1}, {1}};
  EXPECT_THAT([&] { (void)discretize_matched(p, 0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "matched: the plant has 1 input and 2 outputs, expected one of each because "
                  "zeros belong to a channel")));
  p.C = MatrixXd{{1, 0}};
  EXPECT_THAT([&] { (void)discretize_matched(p, -0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr("matched: dt is -0.1 s, expected a positive")));
}

}  // namespace
}  // namespace quadtune
