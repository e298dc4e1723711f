// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/periodic_loop.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <complex>
#include <limits>
#include <random>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;

MatrixXd random_entries(std::mt19937& random, Eigen::Index rows, Eigen::Index cols) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Of spectral radius 0.8 at each step.
PeriodicLti random_periodic_plant(std::mt19937& random, std::size_t N, Eigen::Index nx,
                                  Eigen::Index nu) {
  PeriodicLti plant;
  plant.dt = 0.01;
  for (std::size_t k = 0; k < N; ++k) {
    MatrixXd A = random_entries(random, nx, nx);
    A *= 0.8 / A.eigenvalues().cwiseAbs().maxCoeff();
    plant.A.push_back(A);
    plant.B.push_back(random_entries(random, nx, nu));
  }
  plant.C = random_entries(random, nu, nx);
  return plant;
}

TEST(PeriodicLti, RejectsNonFiniteEntriesAndWrongShapes) {
  std::mt19937 random(1);
  PeriodicLti plant = random_periodic_plant(random, 3, 4, 2);
  EXPECT_NO_THROW(validate(plant, "plant"));
  const auto refused = [&](const PeriodicLti& bad, const std::string& why) {
    try {
      validate(bad, "plant");
      ADD_FAILURE() << "expected a refusal: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  PeriodicLti bad = plant;
  bad.A[1](2, 3) = std::numeric_limits<double>::quiet_NaN();
  refused(bad, "A[1] has an entry that is not finite");
  bad = plant;
  bad.B.pop_back();
  refused(bad, "3 matrices A and 2 matrices B");
  bad = plant;
  bad.B[2] = MatrixXd::Zero(4, 3);
  refused(bad, "B[2] is 4 x 3, expected 4 x 2");
  bad = plant;
  bad.dt = 0;
  refused(bad, "dt is 0 s");
  bad = plant;
  bad.A.clear();
  bad.B.clear();
  refused(bad, "at least one");
}

TEST(PeriodicPoles, OfAConstantSystemAreItsEigenvaluesWhateverThePeriod) {
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    MatrixXd A = random_entries(random, 5, 5);
    A *= 0.95 / A.eigenvalues().cwiseAbs().maxCoeff();
    const Eigen::VectorXcd once = periodic_poles({A});
    const Eigen::VectorXcd thrice = periodic_poles({A, A, A});
    for (Eigen::Index k = 0; k < 5; ++k) {
      double nearest = 1;
      for (const Complex& z : thrice) nearest = std::min(nearest, std::abs(z - once(k)));
      EXPECT_LT(nearest, 1e-6) << i << " " << k;
    }
  }
}

TEST(PeriodicPoles, DescribeTheDecayOverAPeriod) {
  // One state alternately grows threefold and shrinks to a quarter.
  const Eigen::VectorXcd z =
      periodic_poles({MatrixXd::Constant(1, 1, 3), MatrixXd::Constant(1, 1, 0.25)});
  ASSERT_EQ(z.size(), 1);
  EXPECT_NEAR(std::abs(z(0)), std::sqrt(0.75), 1e-14);
}

// Decoupled states are separated; after a rotation of the states they cannot be.
TEST(PeriodicPoles, AreTheSameForDecoupledStates) {
  std::mt19937 random(9);
  for (int i = 0; i < 20; ++i) {
    // Even states are coupled to even states only, and odd to odd ones.
    std::vector<MatrixXd> apart, mixed;
    const MatrixXd turn =
        Eigen::HouseholderQR<MatrixXd>(random_entries(random, 7, 7)).householderQ();
    for (int k = 0; k < 3; ++k) {
      MatrixXd A = 0.4 * random_entries(random, 7, 7);
      for (Eigen::Index row = 0; row < 7; ++row)
        for (Eigen::Index column = 0; column < 7; ++column)
          if ((row + column) % 2 == 1) A(row, column) = 0;
      apart.push_back(A);
      mixed.emplace_back(turn.transpose() * A * turn);
    }
    const Eigen::VectorXcd z = periodic_poles(apart), same = periodic_poles(mixed);
    ASSERT_EQ(z.size(), 7);
    for (Eigen::Index k = 0; k < 7; ++k)
      EXPECT_NEAR(std::abs(z(k)), std::abs(same(k)), 1e-4 * std::abs(z(0))) << i << " " << k;
    std::vector<Signal> names(7);
    for (std::size_t k = 0; k < 7; ++k) names[k].name = k % 2 == 0 ? "even" : "odd";
    const NamedMode mode = largest_mode(apart, names, Eigen::VectorXd::Ones(7));
    EXPECT_NEAR(std::abs(mode.z), std::abs(z(0)), 1e-12);
    // A mode contains only states of one group.
    for (const std::string& name : mode.states) EXPECT_EQ(name, mode.states.front());
  }
}

TEST(LoopPart, KeepsStatesThatAreAffectedAndAffectAnOutput) {
  // 0 drives 1; 1 drives 2 in the second step only; 3 is constant and drives 1; 4 affects no state.
  PeriodicLti plant;
  plant.dt = 1;
  MatrixXd A = MatrixXd::Zero(5, 5);
  A(1, 0) = 1;
  A(3, 3) = 1;
  A(1, 3) = 1;
  A(4, 2) = 1;
  MatrixXd second = A;
  second(2, 1) = 1;
  plant.A = {A, second};
  MatrixXd B = MatrixXd::Zero(5, 1);
  B(0, 0) = 1;
  plant.B = {B, MatrixXd::Zero(5, 1)};
  plant.C = MatrixXd::Zero(1, 5);
  plant.C(0, 2) = 1;
  plant.states = {{"a", ""}, {"b", ""}, {"c", ""}, {"d", ""}, {"e", ""}};
  std::vector<Eigen::Index> kept;
  const PeriodicLti part = loop_part(plant, &kept);
  EXPECT_EQ(kept, (std::vector<Eigen::Index>{0, 1, 2}));
  EXPECT_EQ(names(part.states), "a b c");
  EXPECT_EQ(part.A[1](2, 1), 1);
  EXPECT_EQ(part.C.cols(), 3);
}

TEST(MeanResponse, IsTheFrequencyResponseOfAConstantSystem) {
  std::mt19937 random(3);
  const PeriodicLti once = random_periodic_plant(random, 1, 6, 2);
  PeriodicLti often = once;
  for (int i = 0; i < 6; ++i) {
    often.A.push_back(once.A[0]);
    often.B.push_back(once.B[0]);
  }
  const MeanResponse a(once), b(often);
  for (const double w : {0.0, 0.3, 5.0, 40.0, 200.0, 314.0}) {
    const Eigen::MatrixXcd lambda = std::polar(1.0, w * once.dt) * Eigen::MatrixXcd::Identity(6, 6);
    const Eigen::MatrixXcd expected = once.C * (lambda - once.A[0]).inverse() * once.B[0];
    EXPECT_LT((a.at(w) - expected).norm(), 1e-11 * expected.norm()) << w;
    EXPECT_LT((b.at(w) - expected).norm(), 1e-11 * expected.norm()) << w;
  }
}

TEST(MeanResponse, MatchesASimulation) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 5; ++trial) {
    const std::size_t N = 5;
    const PeriodicLti plant = random_periodic_plant(random, N, 4, 1);
    const MeanResponse response(plant);
    const double w = 13;
    Eigen::VectorXcd x = Eigen::VectorXcd::Zero(4);
    Complex sum = 0;
    const int rounds = 400;
    for (int k = 0; k < rounds * int(N); ++k) {
      const Complex u = std::polar(1.0, w * plant.dt * k);
      if (k >= (rounds - 1) * int(N)) sum += (plant.C * x)(0) / u / double(N);
      const auto i = static_cast<std::size_t>(k) % N;
      x = (plant.A[i] * x + plant.B[i] * u).eval();
    }
    EXPECT_LT(std::abs(response.at(w)(0, 0) - sum), 1e-9 * std::abs(sum)) << trial;
  }
}

TEST(PeriodicMargins, OfAConstantLoopAreThoseOfTheLoop) {
  DiscreteLti plant;
  plant.dt = 0.02;
  plant.A = (MatrixXd(2, 2) << 1, 0.02, 0, 0.9).finished();
  plant.B = (MatrixXd(2, 1) << 0.0002, 0.02).finished();
  plant.C = (MatrixXd(1, 2) << 30, 4).finished();
  const LoopMargins expected = loop_margins(OpenLoop(plant));
  PeriodicLti loop = periodic(plant);
  for (int i = 0; i < 3; ++i) {
    loop.A.push_back(loop.A[0]);
    loop.B.push_back(loop.B[0]);
  }
  const LoopMargins margins = loop_margins(loop);
  EXPECT_TRUE(margins.stable);
  EXPECT_NEAR(margins.phase_margin, expected.phase_margin, 1e-9);
  EXPECT_NEAR(margins.gain_margin, expected.gain_margin, 1e-8 * expected.gain_margin);
  EXPECT_NEAR(margins.Ms, expected.Ms, 1e-9);
  EXPECT_NEAR(margins.disk.alpha, expected.disk.alpha, 1e-9);
}

TEST(PeriodicMargins, AreInfiniteWithoutFeedback) {
  PeriodicLti loop;
  loop.dt = 0.1;
  loop.A = {MatrixXd::Constant(1, 1, 0.5), MatrixXd::Constant(1, 1, 0.4)};
  loop.B = {MatrixXd::Zero(1, 1), MatrixXd::Zero(1, 1)};
  loop.C = MatrixXd::Constant(1, 1, 3);
  const LoopMargins margins = loop_margins(loop);
  EXPECT_TRUE(margins.stable);
  EXPECT_TRUE(margins.gain_crossovers.empty());
  EXPECT_TRUE(std::isinf(margins.gain_margin));
  EXPECT_NEAR(margins.Ms, 1, 1e-15);
}

TEST(PeriodicMargins, RefuseSeveralChannels) {
  std::mt19937 random(5);
  EXPECT_THROW((void)loop_margins(random_periodic_plant(random, 2, 3, 2)), InvalidInput);
}

TEST(Channel, ClosesTheOthers) {
  std::mt19937 random(6);
  const PeriodicLti loop = random_periodic_plant(random, 3, 4, 2);
  const PeriodicLti one = channel(loop, 1);
  const std::vector<MatrixXd> all = closed(loop), last = closed(one);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((all[k] - last[k]).norm(), 1e-14);
}

// Two independent loops: the margins of each are unaffected by the other, even if that is unstable.
TEST(OwnChannels, OmitDecoupledStates) {
  std::mt19937 random(8);
  const PeriodicLti a = random_periodic_plant(random, 3, 4, 1);
  PeriodicLti b = random_periodic_plant(random, 3, 3, 1);
  for (MatrixXd& A : b.A) A *= 4;
  PeriodicLti both;
  both.dt = a.dt;
  for (std::size_t k = 0; k < 3; ++k) {
    MatrixXd A = MatrixXd::Zero(7, 7), B = MatrixXd::Zero(7, 2);
    A.topLeftCorner(4, 4) = a.A[k];
    A.bottomRightCorner(3, 3) = b.A[k];
    B.topLeftCorner(4, 1) = a.B[k];
    B.bottomRightCorner(3, 1) = b.B[k];
    both.A.push_back(A);
    both.B.push_back(B);
  }
  both.C = MatrixXd::Zero(2, 7);
  both.C.topLeftCorner(1, 4) = a.C;
  both.C.bottomRightCorner(1, 3) = b.C;
  const std::vector<PeriodicLti> own = decoupled_channels(both);
  ASSERT_EQ(own.size(), 2);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(own[0].A[k], a.A[k]);
    EXPECT_EQ(own[0].B[k], a.B[k]);
    EXPECT_EQ(own[1].A[k], b.A[k]);
  }
  EXPECT_EQ(own[0].C, a.C);
  // If the loops are coupled, each has all states.
  both.A[1](5, 2) = 0.1;
  for (const PeriodicLti& channel : decoupled_channels(both)) EXPECT_EQ(channel.C.cols(), 7);
}

TEST(LargestMode, NamesTheStatesThatMoveMost) {
  const MatrixXd A = (MatrixXd(3, 3) << 0.99, 0, 0, 0, 0.5, 0, 0, 0, 0.2).finished();
  const NamedMode mode =
      largest_mode({A}, {{"slow", ""}, {"b", ""}, {"c", ""}}, Eigen::VectorXd::Ones(3));
  EXPECT_NEAR(std::abs(mode.z), 0.99, 1e-15);
  EXPECT_EQ(mode.states, std::vector<std::string>{"slow"});
}

}  // namespace
}  // namespace quadtune
