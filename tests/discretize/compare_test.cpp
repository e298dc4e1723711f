// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/compare.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>

#include "methods/sections.hpp"
#include "quadtune/discretize/matched.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"

namespace quadtune {
namespace {

using Method = DiscretizationMethod;

/// Two channels: a resonance and a lag with a zero.
ContinuousLti two_channels() {
  ContinuousLti loop;
  loop.A = Eigen::MatrixXd::Zero(4, 4);
  loop.A.topLeftCorner(2, 2) << 0, 1, -25, -4;
  loop.A.bottomRightCorner(2, 2) << -3, 1, 0, -8;
  loop.B = Eigen::MatrixXd::Zero(4, 2);
  loop.B(1, 0) = 25;
  loop.B(3, 1) = 24;
  loop.C = Eigen::MatrixXd::Zero(2, 4);
  loop.C(0, 0) = 1;
  loop.C(1, 2) = 1;
  loop.D = Eigen::MatrixXd::Zero(2, 2);
  return loop;
}

SamplingError error_of(double dt, Method method) {
  return sampling_error(two_channels(), discretize_channels(two_channels(), dt, method));
}

// One pole at s: Euler puts it at 1 + s dt, which is e^(s dt - (s dt)²/2 + …).
TEST(SamplingErrorTest, OfOnePoleIsAsByHand) {
  ContinuousLti lag;
  lag.A = Eigen::MatrixXd::Constant(1, 1, -2);
  lag.B = Eigen::MatrixXd::Constant(1, 1, 2);
  lag.C = Eigen::MatrixXd::Ones(1, 1);
  lag.D = Eigen::MatrixXd::Zero(1, 1);
  const double dt = 0.1;
  const SamplingError euler = sampling_error(lag, discretize_channels(lag, dt, Method::euler));
  EXPECT_NEAR(euler.pole, std::abs(std::log(0.8) + 0.2) / 0.2, 1e-12);
  // y(k dt) = 1 - e^(-0.2 k) and 1 - 0.8^k: the maximum difference by enumeration.
  double worst = 0;
  double max = 0;
  for (int k = 0; k < 36; ++k) {
    worst = std::max(worst, std::abs(std::exp(-0.2 * k) - std::pow(0.8, k)));
    max = 1 - std::exp(-0.2 * k);
  }
  EXPECT_NEAR(euler.step, worst / max, 1e-3 * worst);
  const SamplingError zoh = sampling_error(lag, discretize_channels(lag, dt, Method::zoh));
  EXPECT_LT(zoh.pole, 1e-13);
  EXPECT_LT(zoh.step, 1e-13);
  // At Nyquist z = -1.
  const double z = std::exp(-0.2);
  const std::complex<double> G = 2.0 / std::complex<double>(2, std::acos(-1.0) / dt);
  EXPECT_GE(zoh.frequency, std::abs((1 - z) / (-1 - z) - G) - 1e-12);
}

TEST(SamplingErrorTest, HasTheOrderOfTheMethod) {
  struct Expected {
    Method method;
    double poles;
    double frequency;
  };
  for (const Expected& e : {Expected{Method::euler, 1, 1}, Expected{Method::backward_euler, 1, 1},
                            Expected{Method::tustin, 2, 2}}) {
    for (const double dt : {0.004, 0.002, 0.001, 0.0005}) {
      const SamplingError coarse = error_of(dt, e.method);
      const SamplingError fine = error_of(dt / 2, e.method);
      EXPECT_NEAR(std::log2(coarse.pole / fine.pole), e.poles, 0.05) << to_string(e.method);
      EXPECT_NEAR(std::log2(coarse.frequency / fine.frequency), e.frequency, 0.05)
          << to_string(e.method);
    }
  }
}

TEST(SamplingErrorTest, ExactMethodsKeepThePoles) {
  for (const Method method : {Method::zoh, Method::foh, Method::impulse, Method::matched})
    for (const double dt : {1e-4, 0.01, 0.3})
      EXPECT_LT(error_of(dt, method).pole, 1e-8) << to_string(method) << " " << dt;
}

TEST(SamplingErrorTest, IsInfiniteWhereStabilityIsLost) {
  const SamplingError lost = error_of(0.3, Method::euler);  // 1 - 8 · 0.3 = -1.4
  EXPECT_FALSE(lost.stable);
  EXPECT_TRUE(std::isinf(lost.step));
  EXPECT_TRUE(std::isinf(lost.frequency));
  EXPECT_TRUE(std::isfinite(lost.pole));
  EXPECT_TRUE(error_of(0.3, Method::tustin).stable);
}

TEST(StabilityLimit, IsTheSameByFormulaAndBySearch) {
  const ContinuousLti loop = two_channels();
  const Eigen::VectorXcd poles = loop.A.eigenvalues();
  const double limit = stability_limit(poles, Method::euler);
  EXPECT_NEAR(limit, 4.0 / 25, 1e-12) << "of s² + 4 s + 25: -2 Re s/|s|²";
  const auto euler = [&](double dt) {
    return Eigen::MatrixXd(Eigen::MatrixXd::Identity(4, 4) + dt * loop.A);
  };
  EXPECT_NEAR(stability_limit(euler, 0.01, 10), limit, 1e-8);
  EXPECT_NEAR(stability_limit(euler, 3, 10), limit, 1e-8);
  EXPECT_TRUE(std::isinf(stability_limit(euler, 0.01, 0.15)));
  EXPECT_TRUE(std::isinf(stability_limit(poles, Method::tustin)));
  const auto never = [](double) { return Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, 2)); };
  EXPECT_EQ(stability_limit(never, 0.01, 1), 0);
  const auto always = [](double) { return Eigen::MatrixXd(Eigen::MatrixXd::Zero(1, 1)); };
  EXPECT_TRUE(std::isinf(stability_limit(always, 0.01, 1)));
}

TEST(ChannelOf, KeepsWhatGoesThrough) {
  ContinuousLti loop = two_channels();
  loop.A(2, 0) = 1e-17;  // rounding, which couples nothing
  EXPECT_EQ(channel_of(loop, 0, 0).A.rows(), 2);
  EXPECT_EQ(channel_of(loop, 1, 1).A.rows(), 2);
  const ContinuousLti nothing = channel_of(loop, 0, 1);
  EXPECT_EQ((nothing.C * nothing.B)(0, 0), 0);
  loop.A(2, 0) = 0.5;
  const ContinuousLti cross = channel_of(loop, 0, 1);
  EXPECT_EQ(cross.A.rows(), 3);
  for (const double w : {0.1, 3.0, 40.0})
    EXPECT_LT(std::abs(FrequencyResponse(cross).at(w)(0, 0) - FrequencyResponse(loop).at(w)(1, 0)),
              1e-14);
}

TEST(SamplingErrorTest, Refuses) {
  ContinuousLti loop = two_channels();
  const DiscreteLti sampled = discretize_channels(loop, 0.01, Method::zoh);
  loop.A(3, 3) = 0;
  EXPECT_THROW((void)sampling_error(loop, sampled), InvalidInput);
  loop = channel_of(two_channels(), 0, 0);
  EXPECT_THROW((void)sampling_error(loop, sampled), InvalidInput);
  EXPECT_THROW((void)channel_of(two_channels(), 2, 0), InvalidInput);
  EXPECT_THROW((void)discretize_channels(two_channels(), 0, Method::zoh), InvalidInput);
}

std::complex<double> product(const Eigen::VectorXcd& roots, std::complex<double> z) {
  std::complex<double> value = 1;
  for (const std::complex<double>& root : roots) value *= z - root;
  return value;
}

/// All ways in which real and complex poles meet real, complex and absent zeros.
TEST(Sections, HaveThePolesZerosAndValueTheyWereGiven) {
  using C = std::complex<double>;
  const std::vector<std::vector<C>> poles = {{0.5},
                                             {0.5, 0.9},
                                             {C(0.9, 0.1), C(0.9, -0.1)},
                                             {0.2, C(0.9, 0.1), C(0.9, -0.1)},
                                             {0.3, 0.3, C(0.5, 0.5), C(0.5, -0.5), 0.99}};
  const std::vector<std::vector<C>> zeros = {{},
                                             {-1},
                                             {0.1, 0.7},
                                             {C(0.2, 0.3), C(0.2, -0.3)},
                                             {-1, C(0.2, 0.3), C(0.2, -0.3)},
                                             {-1, -1, 0.4, C(0.2, 0.3), C(0.2, -0.3)}};
  const auto vector = [](const std::vector<C>& list) {
    return Eigen::VectorXcd(
        Eigen::Map<const Eigen::VectorXcd>(list.data(), static_cast<Eigen::Index>(list.size())));
  };
  for (const auto& p : poles)
    for (const auto& q : zeros) {
      if (q.size() > p.size()) continue;
      const DiscreteLti plant = internal::series_of_sections(vector(p), vector(q), 1.0, 2.5, 0.01);
      const FrequencyResponse response(plant);
      const C scale = 2.5 * product(vector(p), 1) / product(vector(q), 1);
      for (const C z : {C(1, 0), C(0.3, 0.8), C(-1, 0), C(0.99, 0.1)}) {
        const C expected = scale * product(vector(q), z) / product(vector(p), z);
        EXPECT_LT(std::abs(response.at_point(z)(0, 0) - expected), 1e-12 * (1 + std::abs(expected)))
            << p.size() << " poles, " << q.size() << " zeros at " << z;
      }
    }
}

// Six poles within 2 % of 1: as a polynomial they are lost.
TEST(Sections, KeepSlowPolesApart) {
  ContinuousLti chain;
  chain.A = Eigen::MatrixXd::Zero(6, 6);
  chain.A.diagonal() << -0.3, -0.9, -1.4, -3, -5, -8;
  chain.A.diagonal(-1).setOnes();
  chain.B = Eigen::MatrixXd::Zero(6, 1);
  chain.B(0, 0) = 1;
  chain.C = Eigen::MatrixXd::Zero(1, 6);
  chain.C(0, 5) = 1;
  const double dt = 0.0025;
  const DiscreteLti matched = discretize_matched(chain, dt);
  EXPECT_LT(sampling_error(channel_of(chain, 0, 0), matched).pole, 1e-9);
}

}  // namespace
}  // namespace quadtune
