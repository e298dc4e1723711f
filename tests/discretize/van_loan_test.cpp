// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/van_loan.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

/// ∫₀^T f by the Gauss-Legendre rule of 12 points on each of `panels` equal parts.
MatrixXd gauss_legendre(const std::function<MatrixXd(double)>& f, double T, int panels) {
  constexpr int points = 12;
  MatrixXd sum = 0 * f(0);
  for (int i = 0; i < points; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (points + 0.5));
    double slope = 0;
    for (int newton = 0; newton < 20; ++newton) {
      double previous = 1;
      double p = x;  // Legendre polynomials by their recurrence
      for (int k = 2; k <= points; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * previous) / k;
        previous = p;
        p = next;
      }
      slope = points * (x * p - previous) / (x * x - 1);
      x -= p / slope;
    }
    const double weight = 2 / ((1 - x * x) * slope * slope);
    const double h = T / panels;
    for (int panel = 0; panel < panels; ++panel)
      sum += weight * h / 2 * f(h * (panel + (1 + x) / 2));
  }
  return sum;
}

struct Cost {
  MatrixXd A, B, Q, R, N;
};

Cost random_cost(Eigen::Index nx, Eigen::Index nu, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  const MatrixXd L = MatrixXd::NullaryExpr(nx + nu, nx + nu, draw);
  const MatrixXd W = L * L.transpose();
  return {MatrixXd::NullaryExpr(nx, nx, draw), MatrixXd::NullaryExpr(nx, nu, draw),
          W.topLeftCorner(nx, nx), W.bottomRightCorner(nu, nu), W.topRightCorner(nx, nu)};
}

TEST(SampledCost, DoubleIntegratorHasItsClosedForm) {
  for (const double h : {0.005, 0.01, 1.0, 30.0}) {
    const SampledCost cost = sampled_cost(MatrixXd{{0, 1}, {0, 0}}, MatrixXd{{0}, {1}},
                                          MatrixXd{{1, 0}, {0, 0}}, MatrixXd{{1}}, MatrixXd(), h);
    const double h2 = h * h;
    EXPECT_THAT(cost.Q, MatrixRelativelyNear(MatrixXd{{h, h2 / 2}, {h2 / 2, h2 * h / 3}}, 1e-15));
    EXPECT_THAT(cost.N, MatrixRelativelyNear(MatrixXd{{h2 * h / 6}, {h2 * h2 / 8}}, 1e-15));
    EXPECT_THAT(cost.R, MatrixRelativelyNear(MatrixXd{{h + h2 * h2 * h / 20}}, 1e-15));
    EXPECT_THAT(cost.A, MatrixNear(MatrixXd{{1, h}, {0, 1}}, 0));
    EXPECT_THAT(cost.B, MatrixRelativelyNear(MatrixXd{{h2 / 2}, {h}}, 1e-15));
  }
}

TEST(SampledCost, AgreesWithQuadrature) {
  std::mt19937_64 generator(8);
  for (const Eigen::Index nx : {1, 2, 5, 9}) {
    const Eigen::Index nu = 1 + nx % 3;
    const Cost c = random_cost(nx, nu, generator);
    for (const double dt : {0.01, 0.7}) {
      MatrixXd Z = MatrixXd::Zero(nx + nu, nx + nu);
      Z.topRows(nx) << c.A, c.B;
      MatrixXd Y(nx + nu, nx + nu);
      Y << c.Q, c.N, c.N.transpose(), c.R;
      const MatrixXd W = gauss_legendre(
          [&](double t) -> MatrixXd {
            const MatrixXd E = (Z * t).exp();
            return E.transpose() * Y * E;
          },
          dt, 8);
      const SampledCost cost = sampled_cost(c.A, c.B, c.Q, c.R, c.N, dt);
      EXPECT_THAT(cost.Q, MatrixRelativelyNear(W.topLeftCorner(nx, nx), 1e-13)) << nx << " " << dt;
      EXPECT_THAT(cost.R, MatrixRelativelyNear(W.bottomRightCorner(nu, nu), 1e-13));
      EXPECT_THAT(cost.N, MatrixRelativelyNear(W.topRightCorner(nx, nu), 1e-13));
    }
  }
}

TEST(SampledCost, IsVanLoansBlockExponentialWhereThatIsWellConditioned) {
  std::mt19937_64 generator(9);
  const Cost c = random_cost(4, 2, generator);
  const double dt = 0.05;
  MatrixXd M = MatrixXd::Zero(12, 12);  // [-Zᵀ Y; 0 Z], Z = [A B; 0 0]
  M.block(6, 6, 4, 6) << c.A, c.B;
  M.block(0, 0, 6, 6) = -M.block(6, 6, 6, 6).transpose();
  M.block(0, 6, 6, 6) << c.Q, c.N, c.N.transpose(), c.R;
  const MatrixXd E = (M * dt).exp();
  const MatrixXd W = E.block(6, 6, 6, 6).transpose() * E.block(0, 6, 6, 6);
  const SampledCost cost = sampled_cost(c.A, c.B, c.Q, c.R, c.N, dt);
  EXPECT_THAT(cost.Q, MatrixRelativelyNear(W.topLeftCorner(4, 4), 1e-14));
  EXPECT_THAT(cost.N, MatrixRelativelyNear(W.topRightCorner(4, 2), 1e-14));
  EXPECT_THAT(cost.R, MatrixRelativelyNear(W.bottomRightCorner(2, 2), 1e-14));
}

// e^(-Aᵀ dt) of the block form would be 10⁴³⁴ here.
TEST(SampledCost, StaysExactForStiffPlants) {
  const Eigen::Vector3d poles(-1000, -30, -0.1);
  const double dt = 1;
  const MatrixXd Q = MatrixXd::Constant(3, 3, 1) + MatrixXd::Identity(3, 3);
  const SampledCost cost = sampled_cost(MatrixXd(poles.asDiagonal()), MatrixXd::Ones(3, 1), Q,
                                        MatrixXd{{1}}, MatrixXd(), dt);
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double rate = poles[i] + poles[j];
      EXPECT_NEAR(cost.Q(i, j), Q(i, j) * std::expm1(rate * dt) / rate, 1e-14 * cost.Q(i, j));
    }
}

// The cost of two samples with the same input is the cost of one twice as long.
TEST(SampledCost, TwoSamplesAddUp) {
  std::mt19937_64 generator(10);
  const Cost c = random_cost(5, 2, generator);
  const SampledCost half = sampled_cost(c.A, c.B, c.Q, c.R, c.N, 0.1);
  const SampledCost whole = sampled_cost(c.A, c.B, c.Q, c.R, c.N, 0.2);
  const MatrixXd AtQ = half.A.transpose() * half.Q;
  EXPECT_THAT(half.Q + AtQ * half.A, MatrixRelativelyNear(whole.Q, 1e-14));
  EXPECT_THAT(half.N + AtQ * half.B + half.A.transpose() * half.N,
              MatrixRelativelyNear(whole.N, 1e-14));
}

TEST(SampledCost, OfHoverIsSymmetricPositiveAndSharesTheHoldsMatrices) {
  const ContinuousLti p = testing::uquad_hover();
  const SampledCost cost = sampled_cost(p.A, p.B, MatrixXd::Identity(12, 12),
                                        0.01 * MatrixXd::Identity(4, 4), MatrixXd(), 0.01);
  const DiscreteLti d = discretize_zoh(p, 0.01);
  EXPECT_THAT(cost.A, MatrixNear(d.A, 0));
  EXPECT_THAT(cost.B, MatrixNear(d.B, 0));
  EXPECT_THAT(cost.Q, MatrixNear(cost.Q.transpose(), 0));
  EXPECT_THAT(cost.R, MatrixNear(cost.R.transpose(), 0));
  MatrixXd W(16, 16);
  W << cost.Q, cost.N, cost.N.transpose(), cost.R;
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(W).eigenvalues().minCoeff(), 0);
  EXPECT_GT(cost.N.norm(), 0);
}

// Torques in N m move a 60 g vehicle at 2e4 rad/s²: the units must cost no digits.
TEST(SampledCost, KeepsItsDigitsInAnyUnitOfTheInputs) {
  std::mt19937_64 generator(12);
  const Cost c = random_cost(6, 2, generator);
  const double unit = std::ldexp(1.0, 40);
  const SampledCost plain = sampled_cost(c.A, c.B, c.Q, c.R, c.N, 0.3);
  const SampledCost scaled = sampled_cost(c.A, c.B * unit, c.Q, c.R * unit * unit, c.N * unit, 0.3);
  EXPECT_THAT(scaled.Q, MatrixNear(plain.Q, 0));
  EXPECT_THAT(scaled.R / (unit * unit), MatrixNear(plain.R, 0));
  EXPECT_THAT(scaled.N / unit, MatrixNear(plain.N, 0));
}

TEST(SampledNoise, OfAnIntegratedAccelerationHasItsClosedForm) {
  const double q = 0.3;
  for (const double h : {0.001, 0.5, 20.0}) {
    const SampledNoise noise = sampled_noise(MatrixXd{{0, 1}, {0, 0}}, MatrixXd{{0, 0}, {0, q}}, h);
    const MatrixXd expected{{q * h * h * h / 3, q * h * h / 2}, {q * h * h / 2, q * h}};
    EXPECT_THAT(noise.Q, MatrixRelativelyNear(expected, 1e-15));
    EXPECT_THAT(noise.A, MatrixNear(MatrixXd{{1, h}, {0, 1}}, 0));
  }
}

TEST(SampledNoise, OfALagTendsToItsStationaryVariance) {
  const SampledNoise noise = sampled_noise(MatrixXd{{-50}}, MatrixXd{{2}}, 1e3);
  EXPECT_NEAR(noise.Q(0, 0), 2.0 / 100, 1e-16);
}

TEST(SampledNoise, AgreesWithQuadrature) {
  std::mt19937_64 generator(13);
  const Cost c = random_cost(6, 1, generator);
  const MatrixXd expected = gauss_legendre(
      [&](double t) -> MatrixXd {
        const MatrixXd E = (c.A * t).exp();
        return E * c.Q * E.transpose();
      },
      0.4, 8);
  EXPECT_THAT(sampled_noise(c.A, c.Q, 0.4).Q, MatrixRelativelyNear(expected, 1e-13));
}

TEST(SampledCost, RefusesBadArguments) {
  const MatrixXd A = MatrixXd::Zero(2, 2);
  const MatrixXd B = MatrixXd::Ones(2, 1);
  const MatrixXd I = MatrixXd::Identity(2, 2);
  const MatrixXd R{{1}};
  const auto refuses = [](const std::function<void()>& call, const char* message) {
    EXPECT_THAT(call, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refuses([&] { (void)sampled_cost(A, B, I, R, MatrixXd(), 0); }, "sampled_cost: dt is 0 s");
  refuses([&] { (void)sampled_cost(B, B, I, R, MatrixXd(), 1); }, "A is 2x1, expected 2x2");
  refuses([&] { (void)sampled_cost(A, B, R, R, MatrixXd(), 1); }, "Q is 1x1, expected 2x2");
  refuses([&] { (void)sampled_cost(A, B, I, I, MatrixXd(), 1); }, "R is 2x2, expected 1x1");
  refuses([&] { (void)sampled_cost(A, B, I, R, I, 1); }, "N is 2x2, expected 2x1");
  refuses(
      [&] {
        (void)sampled_cost(A, B, MatrixXd{{1, 2}, {0, 1}}, R, MatrixXd(), 1);
      },
      "Q is not symmetric");
  refuses([&] { (void)sampled_cost(I, B, I, R, MatrixXd(), 1e4); }, "expected a shorter period");
  refuses([&] { (void)sampled_noise(A, R, 1); }, "sampled_noise: Q is 1x1, expected 2x2");
  refuses([&] { (void)sampled_noise(A, I, -1); }, "sampled_noise: dt is -1 s");
}

}  // namespace
}  // namespace quadtune
