// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/simultaneous_margins.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

#include "plants/riccati_problems.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

VectorXcd random_vector(Eigen::Index n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return VectorXcd::NullaryExpr(n, [&] { return Complex(normal(random), normal(random)); });
}

void expect_both(const StructuredGain& gain, double expected, double tolerance) {
  EXPECT_NEAR(gain.upper / expected, 1, tolerance);
  EXPECT_NEAR(gain.lower / expected, 1, tolerance);
}

TEST(StructuredGain, ClosedForms) {
  MatrixXcd off(2, 2);
  off << 0, Complex(0, 5000), 0.002, 0;
  expect_both(structured_gain(off), std::sqrt(10.0), 1e-9);
  const VectorXcd d = VectorXcd{{Complex(1, 2), -3, Complex(0, 0.5)}};
  expect_both(structured_gain(d.asDiagonal()), 3, 1e-9);
  std::mt19937_64 random(3);
  for (const Eigen::Index n : {2, 3, 5, 9}) {
    const VectorXcd u = random_vector(n, random);
    const VectorXcd v = random_vector(n, random);
    // Of rank one: Σ |uᵢ vᵢ|.
    expect_both(structured_gain(u * v.adjoint()),
                (u.cwiseAbs().array() * v.cwiseAbs().array()).sum(), 1e-6);
  }
}

TEST(StructuredGain, BoundsMeetUpToThree) {
  std::mt19937_64 random(4);
  for (const Eigen::Index n : {2, 3, 4, 8})
    for (int k = 0; k < 40; ++k) {
      MatrixXcd M(n, n);
      for (Eigen::Index j = 0; j < n; ++j) M.col(j) = random_vector(n, random);
      M.row(0) *= std::pow(10, k % 5);
      const StructuredGain gain = structured_gain(M);
      EXPECT_LE(gain.lower, gain.upper);
      EXPECT_GE(gain.lower, gain.upper * (n <= 3 ? 0.99 : 0.7));
      EXPECT_GE(gain.lower, M.eigenvalues().cwiseAbs().maxCoeff() * (1 - 1e-9));
    }
}

// Seiler, Packard, Gahinet 2020: a spinning body. Each loop alone has perfect margins, both at once
// have not.
TEST(SimultaneousDiskMargin, SpinningBody) {
  ContinuousLti plant;
  plant.A = (MatrixXd(2, 2) << 0, 10, -10, 0).finished();
  plant.B = MatrixXd::Identity(2, 2);
  plant.C = (MatrixXd(2, 2) << 1, 10, -10, 1).finished();
  const OpenLoop loop(plant);
  for (const Eigen::Index i : {0, 1})
    EXPECT_NEAR(loop_margins(loop.channel(i)).disk.alpha, 2, 1e-6);
  const SimultaneousDiskMargin both = simultaneous_disk_margin(loop);
  EXPECT_NEAR(both.guaranteed.alpha, 0.0997, 1e-4);
  EXPECT_NEAR(both.alpha_destabilizing, both.guaranteed.alpha, 1e-6);
}

TEST(SimultaneousDiskMargin, OfOneLoopIsItsDisk) {
  const OpenLoop loop(
      ContinuousTransferFunction{Eigen::VectorXd{{25}}, Eigen::VectorXd{{1, 10, 10, 10}}});
  const SimultaneousDiskMargin margin = simultaneous_disk_margin(loop);
  EXPECT_EQ(margin.guaranteed.alpha, loop_margins(loop).disk.alpha);
  EXPECT_EQ(margin.guaranteed.phase, loop_margins(loop).disk.phase);
  EXPECT_EQ(margin.alpha_destabilizing, margin.guaranteed.alpha);
  // The peak is at infinity, which is not on the grid.
  const OpenLoop lag(ContinuousTransferFunction{Eigen::VectorXd{{3}}, Eigen::VectorXd{{1, 1}}});
  EXPECT_EQ(simultaneous_disk_margin(lag).guaranteed.alpha, 2);
  const OpenLoop unstable(
      ContinuousTransferFunction{Eigen::VectorXd{{1}}, Eigen::VectorXd{{1, 0, 0}}});
  EXPECT_EQ(simultaneous_disk_margin(unstable).guaranteed.alpha, 0);
}

// Diagonal factors inside the guaranteed disk, all at once, leave random loops stable.
TEST(SimultaneousDiskMargin, HoldsForRandomFactors) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 12; ++k) {
    const Eigen::Index n = 4;
    const Eigen::Index m = 2 + k % 2;
    ContinuousLti plant;
    plant.A = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    plant.B = MatrixXd::NullaryExpr(n, m, [&] { return normal(random); });
    const MatrixXd K = lqr(plant, {MatrixXd::Identity(n, n), MatrixXd::Identity(m, m), {}}).K +
                       0.05 * MatrixXd::NullaryExpr(m, n, [&] { return normal(random); });
    const SimultaneousDiskMargin margin = simultaneous_disk_margin(loop_at_inputs(plant, K));
    if (margin.guaranteed.alpha == 0) continue;
    EXPECT_GE(margin.alpha_destabilizing, margin.guaranteed.alpha);
    for (Eigen::Index i = 0; i < m; ++i)
      EXPECT_GE(loop_margins(loop_at_inputs(plant, K).channel(i)).disk.alpha,
                margin.guaranteed.alpha * (1 - 1e-9));
    for (int trial = 0; trial < 300; ++trial) {
      VectorXcd f(m);
      for (Eigen::Index i = 0; i < m; ++i) {
        const Complex delta = std::polar(0.999 * margin.guaranteed.alpha, angle(random));
        f[i] = (1.0 + 0.5 * delta) / (1.0 - 0.5 * delta);
      }
      const MatrixXcd closed =
          plant.A.cast<Complex>() - plant.B.cast<Complex>() * f.asDiagonal() * K.cast<Complex>();
      EXPECT_LT(closed.eigenvalues().real().maxCoeff(), 0);
    }
  }
}

// Two decoupled channels have the smaller of their margins; both peaks are at infinity, where the
// disk is 2.
TEST(SimultaneousDiskMargin, IncludesInfiniteFrequency) {
  ContinuousLti plant;
  plant.A = (MatrixXd(2, 2) << -1, 0, 0, -2).finished();
  plant.B = MatrixXd::Identity(2, 2);
  plant.C = MatrixXd::Identity(2, 2);
  EXPECT_EQ(simultaneous_disk_margin(OpenLoop(plant)).guaranteed.alpha, 2);
}

// Skipping frequencies that cannot be the worst gives the same result as evaluating the whole grid.
TEST(SimultaneousDiskMargin, IsTheWorstOfAllFrequencies) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (const Eigen::Index m : {2, 4, 6}) {
    const Eigen::Index n = m + 2;
    ContinuousLti plant;
    plant.A = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    plant.B = MatrixXd::NullaryExpr(n, m, [&] { return normal(random); });
    const MatrixXd K = lqr(plant, {MatrixXd::Identity(n, n), MatrixXd::Identity(m, m), {}}).K +
                       0.05 * MatrixXd::NullaryExpr(m, n, [&] { return normal(random); });
    const OpenLoop loop = loop_at_inputs(plant, K);
    const SimultaneousDiskMargin margin = simultaneous_disk_margin(loop);
    if (margin.guaranteed.alpha == 0) continue;
    double largest = 0;
    constexpr int kPoints = 698;  // 1e-3 to 1e3 rad/s, 2 % apart
    for (int i = 0; i < kPoints; ++i) {
      const double w = 1e-3 * std::pow(1.02, i);
      largest = std::max(
          largest, structured_gain(loop.sensitivity(w) - 0.5 * MatrixXcd::Identity(m, m)).upper);
    }
    EXPECT_LE(margin.guaranteed.alpha * largest, 1 + 1e-6) << m;
    EXPECT_GE(margin.guaranteed.alpha * largest, 1 - 1e-2) << m;
  }
}

// Four integrators in series make L so large that its rounding errors would exceed the small loops,
// so S must not be computed from L. The margin of one loop alone is never smaller than that of all
// at once.
TEST(SimultaneousDiskMargin, OfAHoverSampledFast) {
  const testing::RiccatiCase hover = testing::small_hover_sampled(0.002);
  DiscreteLti plant;
  plant.A = hover.A;
  plant.B = hover.B;
  plant.dt = 0.002;
  const MatrixXd R = Eigen::Vector4d(1e2, 1e5, 1e5, 1e5).asDiagonal();
  const MatrixXd mix =
      (MatrixXd(4, 4) << 1, 1, 1, 1, 1, -1, 1, -1, 1, 1, -1, -1, 1, -1, -1, 1).finished() / 2;
  // Mixed inputs, as rotors mix thrust and torques.
  const MatrixXd K = mix.transpose() * lqr(plant, {hover.Q, R, {}}).K;
  plant.B = (plant.B * mix).eval();
  const OpenLoop loop = loop_at_inputs(plant, K);
  const SimultaneousDiskMargin margin = simultaneous_disk_margin(loop);
  double min = 2;
  for (Eigen::Index i = 0; i < 4; ++i)
    min = std::min(min, loop_margins(loop.channel(i)).disk.alpha);
  EXPECT_LE(margin.guaranteed.alpha, min * (1 + 1e-9));
  EXPECT_GT(margin.guaranteed.alpha, 0.3);
  EXPECT_NEAR(margin.alpha_destabilizing / margin.guaranteed.alpha, 1, 0.05);
}

}  // namespace
}  // namespace quadtune
