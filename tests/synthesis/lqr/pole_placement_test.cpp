// SPDX-License-Identifier: Apache-2.0
/// Pole placement: Ackermann's formula, and given poles of random plants.
#include "quadtune/synthesis/pole_placement.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <complex>
#include <random>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using Complex = std::complex<double>;

// u = -k1 x - k2 x' gives s² + k2 s + k1.
TEST(PlacePoles, OfADoubleIntegrator) {
  const Eigen::Matrix2d A{{0, 1}, {0, 0}};
  const Eigen::Vector2d B(0, 1);
  const PolePlacement real = place_poles(A, B, Eigen::Vector2cd(-4, -5));
  ASSERT_TRUE(real.solved()) << real.culprit;
  EXPECT_THAT(real.K, MatrixNear(MatrixXd{{20, 9}}, 1e-12));
  const PolePlacement pair = place_poles(A, B, Eigen::Vector2cd(Complex(-1, 2), Complex(-1, -2)));
  ASSERT_TRUE(pair.solved()) << pair.culprit;
  EXPECT_THAT(pair.K, MatrixNear(MatrixXd{{5, 2}}, 1e-12));
  const PolePlacement twice = place_poles(A, B, Eigen::Vector2cd(-3, -3));
  ASSERT_TRUE(twice.solved()) << twice.culprit;
  EXPECT_THAT(twice.K, MatrixNear(MatrixXd{{9, 6}}, 1e-7));
}

/// K = [0 … 0 1] [B AB … ]⁻¹ p(A) for one input.
MatrixXd ackermann(const MatrixXd& A, const MatrixXd& B, const VectorXcd& poles) {
  const Index n = A.rows();
  MatrixXd reach(n, n);
  reach.col(0) = B;
  for (Index i = 1; i < n; ++i) reach.col(i) = A * reach.col(i - 1);
  Eigen::MatrixXcd p = Eigen::MatrixXcd::Identity(n, n);
  for (const Complex& pole : poles)
    p = p * (A.cast<Complex>() - pole * Eigen::MatrixXcd::Identity(n, n));
  return Eigen::RowVectorXd::Unit(n, n - 1) * reach.inverse() * p.real();
}

VectorXcd wanted_poles(Index n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.5, 3);
  VectorXcd poles(n);
  Index i = 0;
  for (; i + 1 < n && random() % 2 == 0; i += 2) {
    poles[i] = Complex(-uniform(random), uniform(random));
    poles[i + 1] = std::conj(poles[i]);
  }
  for (; i < n; ++i) poles[i] = -uniform(random);
  return poles;
}

TEST(PlacePoles, OfOneInputIsAckermannsFormula) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 60; ++trial) {
    const Index n = 1 + trial % 5;
    const ContinuousLti plant = testing::random_plant(n, 1, 1, false, random);
    const VectorXcd poles = wanted_poles(n, random);
    const PolePlacement placed = place_poles(plant.A, plant.B, poles);
    ASSERT_TRUE(placed.solved()) << trial << " " << placed.culprit;
    EXPECT_THAT(placed.K, MatrixRelativelyNear(ackermann(plant.A, plant.B, poles), 1e-6)) << trial;
  }
}

TEST(PlacePoles, OfSeveralInputsAreMet) {
  std::mt19937_64 random(12);
  for (int trial = 0; trial < 60; ++trial) {
    const Index n = 2 + trial % 7;
    const ContinuousLti plant = testing::random_plant(n, 2 + trial % 2, 1, false, random);
    const VectorXcd poles = wanted_poles(n, random);
    const PolePlacement placed = place_poles(plant.A, plant.B, poles);
    ASSERT_TRUE(placed.solved()) << trial << " " << placed.culprit;
    EXPECT_TRUE(placed.K.allFinite());
    EXPECT_LT(placed.error, 1e-6) << trial;
  }
}

// Two decoupled integrators with an input each: equal eigenvalues that one input cannot move alike.
TEST(PlacePoles, OfEqualModesNeedBothInputs) {
  const PolePlacement placed = place_poles(Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Identity(),
                                           Eigen::Vector2cd(Complex(-1, 1), Complex(-1, -1)));
  ASSERT_TRUE(placed.solved()) << placed.culprit;
  EXPECT_EQ(
      place_poles(Eigen::Matrix2d::Zero(), Eigen::Vector2d(1, 1), Eigen::Vector2cd(-1, -2)).status,
      PolePlacementStatus::not_controllable);
}

TEST(PlacePoles, AModeThatCannotMoveIsNamed) {
  const Eigen::Matrix2d A = Eigen::Vector2d(2, -1).asDiagonal();
  const Eigen::Vector2d B(0, 1);
  const PolePlacement stuck = place_poles(A, B, Eigen::Vector2cd(-3, -4));
  EXPECT_EQ(stuck.status, PolePlacementStatus::not_controllable);
  EXPECT_EQ(stuck.culprit, "mode at 2 cannot be controlled");
  EXPECT_TRUE(stuck.K.array().isNaN().all());
  // If it is requested where it is, the others are placed.
  const PolePlacement kept = place_poles(A, B, Eigen::Vector2cd(2, -4));
  ASSERT_TRUE(kept.solved()) << kept.culprit;
  EXPECT_THAT(kept.K, MatrixNear(MatrixXd{{0, 3}}, 1e-12));
}

// Rounding errors of gains of 1e24 are no property of the plant.
TEST(PlacePoles, PolesFarAwayAreDistinguishedFromModesThatCannotMove) {
  Eigen::Matrix2d A;
  A << 0, 1, 0, 0;
  for (const double far : {1e12, 1e15, 1e20, 1e200}) {
    const PolePlacement placed =
        place_poles(A, Eigen::Vector2d(0, 1), Eigen::Vector2cd(-far, -2 * far));
    EXPECT_EQ(placed.status, PolePlacementStatus::inaccurate) << far;
    EXPECT_THAT(placed.culprit, ::testing::HasSubstr("far from those of the plant")) << far;
    EXPECT_TRUE(placed.K.array().isNaN().all());
    const PolePlacement stuck =
        place_poles(Eigen::Matrix2d(Eigen::Vector2d(2, -1).asDiagonal()), Eigen::Vector2d(0, 1),
                    Eigen::Vector2cd(-far, -2 * far));
    EXPECT_EQ(stuck.status, PolePlacementStatus::not_controllable) << far;
  }
}

// A pair is placed at two real modes together, of which no input moves the second.
// In double precision, a pole at -5 is lost beside one at -1e15.
TEST(PlacePoles, EachPoleIsAccurateForItsOwnSize) {
  const Eigen::Matrix2d A{{0, 1}, {0, 0}};
  const Eigen::Vector2d B(0, 1);
  for (const double far : {1e3, 1e6, 1e9}) {
    const PolePlacement placed = place_poles(A, B, Eigen::Vector2cd(-far, -5));
    EXPECT_TRUE(placed.solved()) << far << placed.culprit;
  }
  for (const double far : {1e15, 1e17}) {
    const PolePlacement placed = place_poles(A, B, Eigen::Vector2cd(-far, -5));
    EXPECT_EQ(placed.status, PolePlacementStatus::inaccurate) << far;
    EXPECT_NE(placed.culprit.find("or from one another"), std::string::npos);
  }
}

TEST(PlacePoles, OfTwoModesTheUncontrollableOneIsNamed) {
  for (const double fixed : {2.0, 0.5}) {
    const PolePlacement placed =
        place_poles(Eigen::Matrix2d(Eigen::Vector2d(1, fixed).asDiagonal()), Eigen::Vector2d(1, 0),
                    Eigen::Vector2cd(Complex(3, 1), Complex(3, -1)));
    EXPECT_EQ(placed.status, PolePlacementStatus::not_controllable);
    EXPECT_EQ(placed.culprit, fmt::format("mode at {} cannot be controlled", fixed));
  }
}

TEST(PlacePoles, InvalidInputIsRejected) {
  const Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
  const Eigen::Vector2d B(0, 1);
  EXPECT_THROW((void)place_poles(A, B, VectorXcd::Zero(1)), InvalidInput);
  EXPECT_THROW((void)place_poles(A, B, Eigen::Vector2cd(Complex(-1, 1), -1)), InvalidInput);
  EXPECT_THROW((void)place_poles(A, B, Eigen::Vector2cd(Complex(-1, -1), -1)), InvalidInput);
  EXPECT_THROW((void)place_poles(A, MatrixXd(2, 0), Eigen::Vector2cd(-1, -1)), InvalidInput);
  EXPECT_THROW((void)place_poles(A, Eigen::Vector2d(0, NAN), Eigen::Vector2cd(-1, -1)),
               InvalidInput);
}

}  // namespace
}  // namespace quadtune
