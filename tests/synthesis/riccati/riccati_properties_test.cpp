// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "matrix_near.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using testing::MatrixRelativelyNear;
using testing::RiccatiCase;

RiccatiResult solve(const RiccatiCase& c, bool discrete, const RiccatiOptions& options = {}) {
  return discrete ? dare(c.A, c.B, c.Q, c.R, c.N, options) : care(c.A, c.B, c.Q, c.R, c.N, options);
}

/// Checks the properties of every solution from their definitions.
void expect_stabilizing(const RiccatiCase& c, const RiccatiResult& r, bool discrete,
                        double residual) {
  ASSERT_TRUE(r.solved()) << r;
  ASSERT_TRUE(r.X.allFinite() && r.K.allFinite());
  EXPECT_EQ(r.X, r.X.transpose());
  EXPECT_LE(testing::riccati_residual(c, r.X, discrete), residual) << r;
  EXPECT_LE(r.residual, residual);
  EXPECT_GT(r.rcond, 0);
  EXPECT_LE(r.rcond, 1);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(r.X, Eigen::EigenvaluesOnly);
  EXPECT_GE(eigen.eigenvalues()[0], -1e-13 * r.X.norm());
  const Eigen::EigenSolver<MatrixXd> closed(c.A - c.B * r.K, false);
  if (discrete)
    EXPECT_LT(closed.eigenvalues().cwiseAbs().maxCoeff(), 1);
  else
    EXPECT_LT(closed.eigenvalues().real().maxCoeff(), 0);
  ASSERT_EQ(r.poles.size(), c.A.rows());
}

class RandomPlants : public ::testing::TestWithParam<bool> {};

TEST_P(RandomPlants, AreSolvedToRounding) {
  const bool discrete = GetParam();
  std::mt19937_64 random(2024);
  for (Eigen::Index n = 1; n <= 50; ++n)
    for (const Eigen::Index m : {(n + 2) / 3, n}) {
      SCOPED_TRACE(::testing::Message() << "n = " << n << ", m = " << m);
      const RiccatiCase c = testing::random_case(n, m, discrete, n % 2 == 0, random);
      const RiccatiResult r = solve(c, discrete);
      expect_stabilizing(c, r, discrete, 1e-13);
    }
}

// Above 32 states the doubling steps are done in single precision and corrected.
TEST_P(RandomPlants, LargeOnesAreSolvedToRounding) {
  const bool discrete = GetParam();
  std::mt19937_64 random(77);
  for (const Eigen::Index n : {33, 48, 63, 64, 65, 96, 128, 200}) {
    SCOPED_TRACE(n);
    const RiccatiCase c = testing::random_case(n, (n + 2) / 3, discrete, n % 2 == 0, random);
    const RiccatiResult r = solve(c, discrete);
    expect_stabilizing(c, r, discrete, 1e-13);
    EXPECT_FALSE(r.used_schur);
  }
}

// Problems beyond single precision are solved in double precision: a weight on one state only,
// units that differ by a factor of a million, a loop whose poles differ by ten decades.
TEST_P(RandomPlants, LargeOnesThatSinglePrecisionDoesNotHold) {
  const bool discrete = GetParam();
  std::mt19937_64 random(78);
  const Eigen::Index n = testing::kSanitized ? 20 : 40;
  const RiccatiCase plain = testing::random_case(n, 10, discrete, false, random);
  RiccatiCase one_weight = plain;
  one_weight.Q.setZero();
  one_weight.Q(3, 3) = 1;
  expect_stabilizing(one_weight, solve(one_weight, discrete), discrete, 1e-12);
  Eigen::VectorXd units = Eigen::VectorXd::Ones(n);
  units.head(n / 2).setConstant(0x1p20);
  const auto T = units.asDiagonal();
  const auto T_inverse = units.cwiseInverse().asDiagonal();
  const RiccatiCase in_units{T_inverse * plain.A * T, T_inverse * plain.B, T * plain.Q * T,
                             plain.R};
  expect_stabilizing(in_units, solve(in_units, discrete), discrete, 1e-12);
  RiccatiCase stiff = plain;
  stiff.A *= 0.01;
  stiff.A(0, 0) = discrete ? 1 - 1e-9 : -1e-9;
  stiff.A.row(0).tail(n - 1).setZero();
  stiff.B.row(0) *= 1e-9;
  stiff.Q.row(0).setZero();
  stiff.Q.col(0).setZero();
  stiff.Q(0, 0) = 1e-9;
  expect_stabilizing(stiff, solve(stiff, discrete), discrete, 1e-12);
}

// One doubling step does not suffice, so that the Schur method must solve the problem.
TEST_P(RandomPlants, DoublingAgreesWithSchur) {
  const bool discrete = GetParam();
  std::mt19937_64 random(99);
  for (const Eigen::Index n : {2, 5, 8, 12, 16, 21, 33, 50}) {
    SCOPED_TRACE(n);
    const RiccatiCase c = testing::random_case(n, (n + 2) / 3, discrete, n % 3 == 0, random);
    RiccatiOptions one_step;
    one_step.max_iterations = 1;
    const RiccatiResult doubling = solve(c, discrete);
    const RiccatiResult schur = solve(c, discrete, one_step);
    expect_stabilizing(c, doubling, discrete, 1e-13);
    expect_stabilizing(c, schur, discrete, 1e-12);
    EXPECT_FALSE(doubling.used_schur);
    EXPECT_TRUE(schur.used_schur);
    EXPECT_THAT(doubling.X, MatrixRelativelyNear(schur.X, 1e-14 / schur.rcond));
    EXPECT_NEAR(std::log(doubling.rcond / schur.rcond), 0, 1e-2);  // the same estimate, two ways
  }
}

// x = T z: X becomes Tᵀ X T and K becomes K T.
TEST_P(RandomPlants, ChangeOfStatesChangesXAlike) {
  const bool discrete = GetParam();
  std::mt19937_64 random(3);
  for (const Eigen::Index n : {3, 7, 12, 30}) {
    const RiccatiCase c = testing::random_case(n, (n + 2) / 3, discrete, true, random);
    const MatrixXd T = testing::random_matrix(n, n, random) + 5 * MatrixXd::Identity(n, n);
    const Eigen::PartialPivLU<MatrixXd> lu(T);
    RiccatiCase turned{lu.solve(c.A * T), lu.solve(c.B), T.transpose() * c.Q * T, c.R,
                       T.transpose() * c.N};
    turned.Q = (0.5 * (turned.Q + turned.Q.transpose())).eval();
    const RiccatiResult one = solve(c, discrete);
    const RiccatiResult other = solve(turned, discrete);
    ASSERT_TRUE(one.solved() && other.solved());
    EXPECT_THAT(other.X, MatrixRelativelyNear(T.transpose() * one.X * T, 1e-10));
    EXPECT_THAT(other.K, MatrixRelativelyNear(one.K * T, 1e-10));
  }
}

// Units are powers of two, so that they affect only the balancing.
TEST_P(RandomPlants, UnitsDoNotMatter) {
  const bool discrete = GetParam();
  std::mt19937_64 random(8);
  const RiccatiCase c = testing::random_case(10, 3, discrete, false, random);
  Eigen::VectorXd units(10);
  for (Eigen::Index i = 0; i < 10; ++i)
    units[i] = std::ldexp(1.0, static_cast<int>(7 * i % 31) - 15);
  const auto T = units.asDiagonal();
  const auto T_inverse = units.cwiseInverse().asDiagonal();
  const RiccatiCase other{T_inverse * c.A * T, T_inverse * c.B, T * c.Q * T, c.R};
  const RiccatiResult one = solve(c, discrete);
  const RiccatiResult two = solve(other, discrete);
  ASSERT_TRUE(one.solved() && two.solved()) << one << "; " << two;
  const MatrixXd back = T_inverse * two.X * T_inverse;
  EXPECT_THAT(back, MatrixRelativelyNear(one.X, 1e-13));
}

INSTANTIATE_TEST_SUITE_P(Time, RandomPlants, ::testing::Bool(), [](const auto& time) {
  return std::string(time.param ? "Discrete" : "Continuous");
});

// Decoupled groups of states are solved separately. A change of states couples them, and must not
// change the solution. One group has no input, and one input belongs to no group.
TEST(RiccatiGroups, AreTheSameAsTheWhole) {
  std::mt19937_64 random(21);
  for (const bool discrete : {false, true}) {
    const RiccatiCase one = testing::random_case(3, 2, discrete, true, random);
    const RiccatiCase two = testing::random_case(5, 1, discrete, true, random);
    RiccatiCase c{MatrixXd::Zero(9, 9), MatrixXd::Zero(9, 4), MatrixXd::Zero(9, 9),
                  MatrixXd::Identity(4, 4), MatrixXd::Zero(9, 4)};
    const std::vector<Eigen::Index> states[] = {{7, 0, 3}, {1, 8, 2, 5, 6}};
    const std::vector<Eigen::Index> inputs[] = {{3, 0}, {2}};
    for (const int g : {0, 1}) {
      const RiccatiCase& part = g == 0 ? one : two;
      c.A(states[g], states[g]) = part.A;
      c.B(states[g], inputs[g]) = part.B;
      c.Q(states[g], states[g]) = part.Q;
      c.R(inputs[g], inputs[g]) = part.R;
      c.N(states[g], inputs[g]) = part.N;
    }
    c.A(4, 4) = discrete ? 0.5 : -1;
    c.Q(4, 4) = 3;
    const RiccatiResult r = solve(c, discrete);
    expect_stabilizing(c, r, discrete, 1e-13);
    EXPECT_NEAR(r.X(4, 4), discrete ? 4 : 1.5, 1e-14);
    EXPECT_EQ(r.K.row(1).norm(), 0);
    const MatrixXd mixing =
        Eigen::HouseholderQR<MatrixXd>(testing::random_matrix(9, 9, random)).householderQ();
    RiccatiCase mixed{mixing.transpose() * c.A * mixing, mixing.transpose() * c.B,
                      mixing.transpose() * c.Q * mixing, c.R, mixing.transpose() * c.N};
    mixed.Q = (0.5 * (mixed.Q + mixed.Q.transpose())).eval();
    const RiccatiResult whole = solve(mixed, discrete);
    ASSERT_TRUE(whole.solved()) << whole;
    // The change of states rounds the data, so both solutions agree only as far as the condition
    // permits.
    const double bound = 100 * std::numeric_limits<double>::epsilon() / whole.rcond;
    EXPECT_THAT(r.X, MatrixRelativelyNear(mixing * whole.X * mixing.transpose(), bound));
    EXPECT_NEAR(std::log(r.rcond / whole.rcond), 0, 0.05);
  }
}

// A 60 g quadrotor in SI units: Schur solvers without scaling leave 1e-8 here.
TEST(RiccatiScaling, HoverInSiUnits) {
  for (const double r : {1e-3, 1.0, 1e3, 1e6}) {
    RiccatiCase continuous = testing::small_hover();
    continuous.R *= r;
    expect_stabilizing(continuous, solve(continuous, false), false, 1e-13);
    RiccatiCase discrete = testing::small_hover_sampled(0.005);
    discrete.R *= r;
    expect_stabilizing(discrete, solve(discrete, true), true, 1e-13);
  }
}

TEST(RiccatiScaling, WeightsFromMillionthsToMillions) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> exponent(-6, 6);
  for (int k = 0; k < (testing::kSanitized ? 8 : 40); ++k) {
    RiccatiCase continuous = testing::small_hover();
    RiccatiCase discrete = testing::small_hover_sampled(0.01);
    for (Eigen::Index i = 0; i < 12; ++i)
      continuous.Q(i, i) = discrete.Q(i, i) = std::pow(10, exponent(random));
    for (Eigen::Index i = 0; i < 4; ++i)
      continuous.R(i, i) = discrete.R(i, i) = std::pow(10, exponent(random) / 2);
    SCOPED_TRACE(k);
    expect_stabilizing(continuous, solve(continuous, false), false, 1e-13);
    expect_stabilizing(discrete, solve(discrete, true), true, 1e-13);
  }
}

// Four integrators in a row under one input: a stiff chain, pole range from the weights.
TEST(RiccatiScaling, IntegratorChains) {
  for (Eigen::Index n = 2; n <= 8; ++n)
    for (const double weight : {1e-6, 1.0, 1e6}) {
      RiccatiCase c{MatrixXd::Zero(n, n), MatrixXd::Zero(n, 1), MatrixXd::Zero(n, n),
                    MatrixXd::Identity(1, 1)};
      for (Eigen::Index i = 0; i + 1 < n; ++i) c.A(i, i + 1) = 1;
      c.B(n - 1, 0) = 1;
      c.Q(0, 0) = weight;  // Butterworth poles of radius weight^(1/2n)
      const RiccatiResult r = solve(c, false);
      expect_stabilizing(c, r, false, 1e-13);
      const double radius = std::pow(weight, 0.5 / static_cast<double>(n));
      for (const std::complex<double> pole : r.poles) EXPECT_NEAR(std::abs(pole) / radius, 1, 1e-9);
    }
}

}  // namespace
}  // namespace quadtune
