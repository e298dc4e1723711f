// SPDX-License-Identifier: Apache-2.0
#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <random>

#include "matrix_near.hpp"
#include "plants/slicot_example.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/synthesis/lyapunov.hpp"
#include "quadtune/transfer_function.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

ContinuousLti resonance(double zeta) {
  return realize(ContinuousTransferFunction{VectorXd{{1}}, VectorXd{{1, 2 * zeta, 1}}});
}

TEST(PeakGain, OfAResonance) {
  for (const double zeta : {0.6, 0.1, 1e-3, 1e-6}) {
    const PeakGain peak = peak_gain(resonance(zeta));
    EXPECT_TRUE(peak.stable);
    EXPECT_NEAR(peak.gain * 2 * zeta * std::sqrt(1 - zeta * zeta), 1, 1e-9) << zeta;
    EXPECT_NEAR(peak.w, std::sqrt(1 - 2 * zeta * zeta), 1e-4) << zeta;
  }
  EXPECT_NEAR(peak_gain(resonance(2)).gain, 1, 1e-12);  // at rest
  EXPECT_EQ(peak_gain(resonance(0)).gain, kInfinite);
}

// The norm of a scaled plant is the scaled norm, however small.
TEST(PeakGain, ScalesWithThePlant) {
  for (const double scale : {1e-9, 1e-3, 1e6}) {
    ContinuousLti plant = resonance(0.1);
    plant.C *= scale;
    const PeakGain peak = peak_gain(plant);
    EXPECT_NEAR(peak.gain / scale * 0.2 * std::sqrt(0.99), 1, 1e-9) << scale;
    EXPECT_NEAR(peak.w, std::sqrt(0.98), 1e-4) << scale;
  }
}

TEST(PeakGain, AtTheEnds) {
  // (3 s + 1)/(s + 1) ends at 3; 1/(s - 2) is not stable, and its L∞ norm is 1/2.
  const PeakGain high =
      peak_gain(realize(ContinuousTransferFunction{VectorXd{{3, 1}}, VectorXd{{1, 1}}}));
  EXPECT_NEAR(high.gain, 3, 1e-12);
  const PeakGain unstable =
      peak_gain(realize(ContinuousTransferFunction{VectorXd{{1}}, VectorXd{{1, -2}}}));
  EXPECT_NEAR(unstable.gain, 0.5, 1e-12);
  EXPECT_FALSE(unstable.stable);
  // 1/(z + 0.9) is largest at Nyquist.
  const PeakGain nyquist =
      peak_gain(realize(DiscreteTransferFunction{VectorXd{{1}}, VectorXd{{1, 0.9}}, 0.1}));
  EXPECT_NEAR(nyquist.gain, 10, 1e-9);
  EXPECT_NEAR(nyquist.w, std::numbers::pi / 0.1, 1e-6);
  const PeakGain on_circle =
      peak_gain(realize(DiscreteTransferFunction{VectorXd{{1}}, VectorXd{{1, 1}}, 0.1}));
  EXPECT_EQ(on_circle.gain, kInfinite);
}

// The gain on a dense grid does not exceed the norm, and almost attains it.
TEST(PeakGain, OfRandomPlants) {
  std::mt19937_64 random(8);
  const auto normal = [&](Eigen::Index r, Eigen::Index c) {
    return MatrixXd::NullaryExpr(r, c, [&] { return std::normal_distribution<double>()(random); });
  };
  for (int k = 0; k < 20; ++k) {
    const Eigen::Index n = 1 + k % 9;
    DiscreteLti plant;
    plant.A = normal(n, n);
    plant.A *= 0.95 / plant.A.norm();
    plant.B = normal(n, 2);
    plant.C = normal(3, n);
    plant.D = normal(3, 2);
    plant.dt = 0.5;
    const PeakGain peak = peak_gain(plant);
    const FrequencyResponse response(plant);
    double dense = 0;
    for (int i = 0; i <= 4000; ++i)
      dense = std::max(
          dense, Eigen::JacobiSVD<Eigen::MatrixXcd>(response.at(std::numbers::pi / 0.5 * i / 4000))
                     .singularValues()[0]);
    EXPECT_GE(peak.gain, dense * (1 - 1e-9));
    EXPECT_LE(peak.gain, dense * (1 + 1e-4));
  }
}

TEST(PeakGain, SlicotExample) {
  QUADTUNE_REQUIRE_DATA(data);
  ContinuousLti plant;
  plant.A = testing::matrix_after(data / "known/slicot/AB13DD.dat", "C     I     N", 6, 6);
  plant.B = VectorXd{{1, 0, 1, 0, 1, 0}};
  plant.C = VectorXd{{1, 0, 1, 0, 1, 0}}.transpose();
  const PeakGain peak = peak_gain(plant);
  EXPECT_NEAR(peak.gain / 0.5000000001e6, 1, 1e-9);  // as printed
  EXPECT_NEAR(peak.w, 1.414213562, 1e-9);
}

TEST(H2Norm, ClosedForms) {
  const double a = 0.7;
  EXPECT_NEAR(h2_norm(realize(ContinuousTransferFunction{VectorXd{{1}}, VectorXd{{1, a}}})),
              1 / std::sqrt(2 * a), 1e-14);
  EXPECT_NEAR(h2_norm(resonance(0.2)), 1 / std::sqrt(4 * 0.2), 1e-13);
  EXPECT_NEAR(h2_norm(realize(DiscreteTransferFunction{VectorXd{{1}}, VectorXd{{1, -a}}, 0.1})),
              1 / std::sqrt(1 - a * a), 1e-14);
  // With feed-through: one additional sample of size 1.
  EXPECT_NEAR(h2_norm(realize(DiscreteTransferFunction{VectorXd{{1, 0}}, VectorXd{{1, -a}}, 0.1})),
              1 / std::sqrt(1 - a * a), 1e-14);
  EXPECT_EQ(h2_norm(realize(ContinuousTransferFunction{VectorXd{{1, 0}}, VectorXd{{1, a}}})),
            kInfinite);
  EXPECT_EQ(h2_norm(resonance(-0.1)), kInfinite);
}

TEST(Gramians, SolveTheirEquations) {
  std::mt19937_64 random(9);
  ContinuousLti plant;
  plant.A = MatrixXd::NullaryExpr(5, 5, [&] { return std::normal_distribution<double>()(random); });
  plant.A -= 4 * MatrixXd::Identity(5, 5);
  plant.B = plant.A.leftCols(2);
  plant.C = plant.A.topRows(1);
  const MatrixXd Wc = controllability_gramian(plant);
  const MatrixXd Wo = observability_gramian(plant);
  EXPECT_THAT(plant.A * Wc + Wc * plant.A.transpose() + plant.B * plant.B.transpose(),
              testing::MatrixNear(MatrixXd(MatrixXd::Zero(5, 5)), 1e-11));
  EXPECT_THAT(plant.A.transpose() * Wo + Wo * plant.A + plant.C.transpose() * plant.C,
              testing::MatrixNear(MatrixXd(MatrixXd::Zero(5, 5)), 1e-11));
  // Both Gramians yield the same energy.
  EXPECT_NEAR((plant.C * Wc * plant.C.transpose()).trace(),
              (plant.B.transpose() * Wo * plant.B).trace(), 1e-11);
  EXPECT_THAT([] { (void)controllability_gramian(resonance(-0.1)); },
              ThrowsMessage<InvalidInput>(HasSubstr("A has a pole at 0.1")));
}

TEST(PeakGain, Refusals) {
  EXPECT_THAT(
      [] { (void)peak_gain(resonance(1), 0); },
      ThrowsMessage<InvalidInput>(HasSubstr("tolerance is 0, expected a number in (0, 0.1]")));
  DiscreteLti sampled;
  sampled.A = sampled.B = sampled.C = MatrixXd::Constant(1, 1, 0.5);
  sampled.dt = 0.1;
  for (const double tolerance : {std::nan(""), 0.0, -1e-3, 0.2})
    EXPECT_THAT([&] { (void)peak_gain(sampled, tolerance); },
                ThrowsMessage<InvalidInput>(HasSubstr("expected a number in (0, 0.1]")))
        << tolerance;
}

}  // namespace
}  // namespace quadtune
