// SPDX-License-Identifier: Apache-2.0
/// Margins of frequency response data against those of the loop that the data were computed from.
#include "quadtune/synthesis/frequency_data.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;

/// 25 e^(-delay s)/(s³ + 10 s² + 10 s + 10) at frequencies that are spaced evenly in log w.
ContinuousTransferFunction example(double delay) {
  return {Eigen::VectorXd::Constant(1, 25), Eigen::Vector4d(1, 10, 10, 10), delay};
}

FrequencyData samples_of(const ContinuousTransferFunction& L, double low, double high, int count) {
  FrequencyData data{Eigen::VectorXd(count), Eigen::VectorXcd(count)};
  for (int i = 0; i < count; ++i) {
    data.w[i] = low * std::pow(high / low, double{1} * i / (count - 1));
    data.G[i] = L(Complex(0, data.w[i]));
  }
  return data;
}

TEST(FrequencyDataMargins, AreThoseOfTheLoop) {
  const ContinuousTransferFunction L = example(0.02);
  for (const double skew : {0.0, 1.0, -1.0}) {
    const LoopMargins exact = loop_margins(OpenLoop(L), skew);
    const LoopMargins data =
        frequency_data_margins(samples_of(L, 0.01, 100, 2000), true, skew).margins;
    EXPECT_NEAR(data.gain_margin, exact.gain_margin, 1e-4 * exact.gain_margin);
    EXPECT_NEAR(data.phase_margin, exact.phase_margin, 1e-5);
    EXPECT_NEAR(data.crossover, exact.crossover, 1e-4 * exact.crossover);
    EXPECT_NEAR(data.delay_margin, exact.delay_margin, 1e-4 * exact.delay_margin);
    EXPECT_NEAR(data.Ms, exact.Ms, 1e-4 * exact.Ms);
    EXPECT_NEAR(data.w_Ms, exact.w_Ms, 1e-2 * exact.w_Ms);
    EXPECT_NEAR(data.Mt, exact.Mt, 1e-4 * exact.Mt);
    EXPECT_NEAR(data.disk.alpha, exact.disk.alpha, 1e-4);
    EXPECT_NEAR(data.disk.gain_high, exact.disk.gain_high, 1e-3 * exact.disk.gain_high);
  }
}

// An integrator with delay: |L| = 1/w and the phase -π/2 - w T are interpolated, and the phase
// crossover is a closed form: w T = π/2.
TEST(FrequencyDataMargins, OfAnIntegratorAreClosedForms) {
  const ContinuousTransferFunction L{Eigen::VectorXd::Ones(1), Eigen::Vector2d(1, 0), 0.5};
  const FrequencyDataMargins data = frequency_data_margins(samples_of(L, 0.1, 10, 4000));
  EXPECT_NEAR(data.margins.crossover, 1, 1e-12);  // log|L| is linear in log w
  EXPECT_NEAR(data.margins.phase_margin, std::numbers::pi / 2 - 0.5, 1e-6);
  EXPECT_NEAR(data.margins.gain_margin, std::numbers::pi, 1e-5);
  EXPECT_TRUE(data.crosses_gain);
  EXPECT_TRUE(data.crosses_phase);
}

TEST(FrequencyDataMargins, OpenLoopOfClosedLoopMeasurements) {
  const FrequencyData L = samples_of(example(0), 0.1, 10, 50);
  FrequencyData T = L, S = L;
  T.G = L.G.array() / (1.0 + L.G.array());
  S.G = 1.0 / (1.0 + L.G.array());
  const FrequencyData of_T = open_loop_of(T, MeasuredResponse::complementary_sensitivity);
  const FrequencyData of_S = open_loop_of(S, MeasuredResponse::sensitivity);
  EXPECT_LT((of_T.G - L.G).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((of_S.G - L.G).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(open_loop_of(L, MeasuredResponse::loop).G, L.G);
}

TEST(FrequencyDataMargins, NothingIsExtrapolated) {
  const FrequencyDataMargins low = frequency_data_margins(samples_of(example(0), 0.01, 0.5, 50));
  EXPECT_FALSE(low.crosses_gain);
  EXPECT_FALSE(low.crosses_phase);
  EXPECT_TRUE(std::isinf(low.margins.gain_margin));
  EXPECT_TRUE(std::isinf(low.margins.phase_margin));
  EXPECT_TRUE(std::isfinite(low.margins.Ms));
}

// Three samples of a pure delay: the phase steps by 2 rad.
TEST(FrequencyDataMargins, CoarseDataAreRecognized) {
  FrequencyData data{Eigen::Vector3d(1, 3, 5), Eigen::VectorXcd(3)};
  for (int i = 0; i < 3; ++i) data.G[i] = std::polar(0.5, -data.w[i]);
  const FrequencyDataMargins margins = frequency_data_margins(data);
  EXPECT_NEAR(margins.largest_phase_step, 2, 1e-12);
  ASSERT_EQ(margins.margins.phase_crossovers.size(), 1U);
  EXPECT_NEAR(margins.margins.gain_margin, 2, 1e-12);
}

// A sample that lies exactly on |L| = 1 is one crossover, not two; the last sample counts, too.
TEST(FrequencyDataMargins, CrossoverAtASample) {
  FrequencyData data{Eigen::Vector3d(1, 2, 3), Eigen::VectorXcd(3)};
  data.G << Complex(0, -2), Complex(0, -1), Complex(0, -0.5);
  EXPECT_EQ(frequency_data_margins(data).margins.gain_crossovers.size(), 1U);
  data.G << Complex(0, -0.5), Complex(0, -1), Complex(0, -2);
  EXPECT_EQ(frequency_data_margins(data).margins.gain_crossovers.size(), 1U);
  data.G << Complex(0, -3), Complex(0, -2), Complex(0, -1);
  const LoopMargins last = frequency_data_margins(data).margins;
  ASSERT_EQ(last.gain_crossovers.size(), 1U);
  EXPECT_NEAR(last.crossover, 3, 1e-12);
  EXPECT_NEAR(last.phase_margin, std::numbers::pi / 2, 1e-12);
}

TEST(FrequencyDataMargins, InvalidDataAreRejected) {
  const FrequencyData good = samples_of(example(0), 0.1, 10, 5);
  FrequencyData data = good;
  data.w[2] = data.w[1];
  EXPECT_THROW((void)frequency_data_margins(data), InvalidInput);
  data = good;
  data.G[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)frequency_data_margins(data), InvalidInput);
  data = good;
  data.G[3] = 0;
  EXPECT_THROW((void)frequency_data_margins(data), InvalidInput);
  data = good;
  data.G[3] = 1;
  EXPECT_THROW((void)open_loop_of(data, MeasuredResponse::sensitivity), InvalidInput);
  EXPECT_THROW((void)open_loop_of(data, MeasuredResponse::complementary_sensitivity), InvalidInput);
  EXPECT_THROW((void)frequency_data_margins(samples_of(example(0), 1, 2, 1)), InvalidInput);
}

}  // namespace
}  // namespace quadtune
