// SPDX-License-Identifier: Apache-2.0
/// LQG regulators: separation of the poles, and the mean cost by a second formula.
#include "quadtune/synthesis/lqg_regulator.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <complex>
#include <random>
#include <vector>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

/// The largest distance between two sets of poles, paired greedily.
double distance(const Eigen::VectorXcd& a, std::vector<Complex> b) {
  double largest = 0;
  for (const Complex& pole : a) {
    const auto nearest = std::min_element(b.begin(), b.end(), [&](Complex p, Complex q) {
      return std::abs(p - pole) < std::abs(q - pole);
    });
    largest = std::max(largest, std::abs(*nearest - pole));
    b.erase(nearest);
  }
  return largest;
}

template <class Lti>
std::vector<Complex> separate_poles(const LqgRegulator<Lti>& regulator) {
  std::vector<Complex> poles(regulator.lqr.poles.begin(), regulator.lqr.poles.end());
  poles.insert(poles.end(), regulator.filter.poles.begin(), regulator.filter.poles.end());
  return poles;
}

struct Problem {
  ContinuousLti plant;
  LqrWeights weights;
  KalmanNoise noise;
};

Problem draw(std::mt19937_64& random, bool feed_through) {
  Problem p;
  p.plant = testing::random_plant(3, 2, 2, feed_through, random);
  p.weights = {Eigen::Vector3d(1, 2, 3).asDiagonal(), 0.5 * MatrixXd::Identity(2, 2), {}};
  p.noise = {{}, Eigen::Vector3d(0.3, 0.2, 0.1).asDiagonal(), 0.4 * MatrixXd::Identity(2, 2), {}};
  return p;
}

// J = tr(S W) + tr(Kᵀ R K P).
TEST(LqgRegulator, ContinuousCostAndPoles) {
  std::mt19937_64 random(21);
  for (const bool feed_through : {false, true}) {
    const Problem p = draw(random, feed_through);
    const LqgRegulator<ContinuousLti> r = lqg_regulator(p.plant, p.weights, p.noise);
    ASSERT_TRUE(r.solved());
    EXPECT_LT(distance(r.poles, separate_poles(r)), 1e-7);
    const double expected = (r.lqr.X * p.noise.Q).trace() +
                            (r.lqr.K.transpose() * p.weights.R * r.lqr.K * r.filter.P).trace();
    EXPECT_NEAR(r.cost, expected, 1e-9 * expected);
    EXPECT_TRUE(r.state_rms.allFinite());
    EXPECT_TRUE(r.input_rms.allFinite());
  }
}

// J = tr(S W) + tr(Kᵀ (R + BᵀSB) K Z), with the covariance of the estimate that is used.
TEST(LqgRegulator, DiscreteCostAndPoles) {
  std::mt19937_64 random(22);
  for (int trial = 0; trial < 4; ++trial) {
    Problem p = draw(random, trial % 2 == 1);
    const DiscreteLti plant{0.4 * p.plant.A, p.plant.B, p.plant.C, p.plant.D, 0.01, {}, {}, {}};
    if (trial >= 2) p.weights.N = 0.1 * MatrixXd::Ones(3, 2);
    for (const LqgEstimate estimate : {LqgEstimate::current, LqgEstimate::delayed}) {
      const LqgRegulator<DiscreteLti> r = lqg_regulator(plant, p.weights, p.noise, estimate);
      ASSERT_TRUE(r.solved());
      EXPECT_LT(distance(r.poles, separate_poles(r)), 1e-7);
      const MatrixXd weight = p.weights.R + plant.B.transpose() * r.lqr.X * plant.B;
      const MatrixXd& error = estimate == LqgEstimate::current ? r.filter.Z : r.filter.P;
      const double expected =
          (r.lqr.X * p.noise.Q).trace() + (r.lqr.K.transpose() * weight * r.lqr.K * error).trace();
      EXPECT_NEAR(r.cost, expected, 1e-9 * expected) << trial;
      EXPECT_EQ(r.controller.dt, 0.01);
    }
  }
}

TEST(LqgRegulator, AFailureHasItsStatus) {
  DiscreteLti plant{MatrixXd{{2}}, MatrixXd{{0}}, MatrixXd{{1}}, {}, 1, {}, {}, {}};
  const MatrixXd one = MatrixXd::Ones(1, 1);
  const LqgRegulator<DiscreteLti> unreachable =
      lqg_regulator(plant, {one, one, {}}, {{}, one, one, {}});
  EXPECT_FALSE(unreachable.solved());
  EXPECT_EQ(unreachable.lqr.status, RiccatiStatus::not_stabilizable);
  plant.B = one;
  plant.C = MatrixXd::Zero(1, 1);
  const LqgRegulator<DiscreteLti> unseen = lqg_regulator(plant, {one, one, {}}, {{}, one, one, {}});
  EXPECT_FALSE(unseen.solved());
  EXPECT_EQ(unseen.filter.status, RiccatiStatus::not_detectable);
}

}  // namespace
}  // namespace quadtune
