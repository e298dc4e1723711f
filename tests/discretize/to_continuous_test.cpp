// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/to_continuous.hpp"

#include <cmath>
#include <random>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/discretize/tustin.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;
using Method = DiscretizationMethod;

void expect_same(const ContinuousLti& got, const ContinuousLti& want, double tolerance) {
  EXPECT_THAT(got.A, MatrixRelativelyNear(want.A, tolerance));
  EXPECT_THAT(got.B, MatrixRelativelyNear(want.B, tolerance));
  EXPECT_THAT(got.C, MatrixRelativelyNear(want.C, tolerance));
  EXPECT_THAT(got.D, MatrixRelativelyNear(want.D, tolerance));
}

TEST(ToContinuous, UndoesTheHoldAndTustinOfRandomPlants) {
  std::mt19937_64 generator(13);
  for (int trial = 0; trial < 200; ++trial) {
    const ContinuousLti p = testing::random_plant(1 + trial % 16, 2, 3, true, generator);
    const double dt = trial % 2 ? 0.02 : 0.5;
    SCOPED_TRACE(trial);
    expect_same(to_continuous(discretize_zoh(p, dt), Method::zoh), p, 1e-12);
    expect_same(to_continuous(discretize_tustin(p, dt), Method::tustin), p, 1e-12);
    expect_same(to_continuous(discretize_tustin(p, dt, 3.0), Method::tustin, 3.0), p, 1e-12);
  }
}

// Twelve poles at 0 in Jordan chains, so A has no eigenvector basis.
TEST(ToContinuous, UndoesTheHoldOfHover) {
  const ContinuousLti p = testing::uquad_hover();
  const ContinuousLti again = to_continuous_zoh(discretize_zoh(p, 0.01));
  EXPECT_THAT(again.A, MatrixNear(p.A, 1e-12));
  EXPECT_THAT(again.B, MatrixRelativelyNear(p.B, 1e-12));
  EXPECT_EQ(again.states, p.states);
  EXPECT_EQ(again.inputs, p.inputs);
}

// A plant without C has its states as outputs. Tustin's method computes a C for them, so the result
// has outputs, with the names of the states.
TEST(ToContinuous, OutputsWithoutCAreTheStates) {
  DiscreteLti plant;
  plant.A = MatrixXd{{0.9, 0.1}, {0, 0.8}};
  plant.B = MatrixXd{{0.1}, {0.2}};
  plant.dt = 0.1;
  plant.states = {{"angle", "rad"}, {"rate", "rad/s"}};
  plant.inputs = {{"torque", "N m"}};
  const ContinuousLti without = to_continuous(plant, Method::tustin);
  EXPECT_EQ(without.outputs, plant.states);
  plant.C = MatrixXd{{1, 0}};
  plant.outputs = {{"sensor", "V"}};
  EXPECT_EQ(to_continuous(plant, Method::tustin).outputs, plant.outputs);
}

TEST(ToContinuous, UndoesTransferFunctions) {
  const auto list = [](std::initializer_list<double> numbers) {
    return VectorXd(Eigen::Map<const VectorXd>(numbers.begin(), std::ssize(numbers)));
  };
  for (const ContinuousTransferFunction& p :
       {ContinuousTransferFunction{list({0, 2}), list({1, 3})},
        ContinuousTransferFunction{list({0, 0, 9.81}), list({1, 0, 0}), 0.4},
        ContinuousTransferFunction{list({1, 2, 3}), list({1, 2, 50})},
        ContinuousTransferFunction{list({3}), list({1})}}) {
    for (const Method method : {Method::zoh, Method::tustin}) {
      const ContinuousTransferFunction again = to_continuous(discretize(p, 0.1, method), method);
      EXPECT_THAT(again.num, MatrixNear(p.num, 1e-12 * p.den.cwiseAbs().maxCoeff() * 100))
          << to_string(method);
      EXPECT_THAT(again.den, MatrixNear(p.den, 1e-12 * p.den.cwiseAbs().maxCoeff() * 100));
      EXPECT_DOUBLE_EQ(again.delay, p.delay);
    }
  }
}

DiscreteLti with_A(const MatrixXd& A) {
  DiscreteLti plant;
  plant.A = A;
  plant.B = MatrixXd::Ones(A.rows(), 1);
  plant.dt = 0.1;
  return plant;
}

TEST(ToContinuous, RefusesPolesThatNoHoldHas) {
  EXPECT_THAT(
      [] {
        (void)to_continuous_zoh(with_A(MatrixXd{{0.5, 1}, {0, -0.25}}));
      },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "zoh: A has a pole at -0.25, expected none on the negative real axis, because")));
  EXPECT_THAT(
      [] {
        (void)to_continuous_zoh(with_A(MatrixXd{{0.5, 1}, {0, 0}}));
      },
      ThrowsMessage<InvalidInput>(
          HasSubstr("zoh: A has a pole at 0, expected none because no continuous mode decays to "
                    "zero in one sample; remove delays")));
  // A delay alone: the pole and the rounding of A are both exactly 0.
  EXPECT_THAT([] { (void)to_continuous_zoh(with_A(MatrixXd{{0}})); },
              ThrowsMessage<InvalidInput>(HasSubstr("zoh: A has a pole at 0, expected none")));
  EXPECT_THAT(
      [] {
        (void)to_continuous_tustin(with_A(MatrixXd{{0.5, 1}, {0, -1}}));
      },
      ThrowsMessage<InvalidInput>(HasSubstr("tustin: A has a pole at -1, expected none because")));
  EXPECT_THAT([] { (void)to_continuous_tustin(with_A(MatrixXd{{0.5}}), 32.0); },
              ThrowsMessage<InvalidInput>(HasSubstr("tustin: prewarp is 32 rad/s, expected")));
}

TEST(ToContinuous, RefusesOtherMethods) {
  EXPECT_THAT([] { (void)to_continuous(with_A(MatrixXd{{0.5}}), Method::foh); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("foh: conversion to continuous time supports only zoh and tustin")));
  EXPECT_THAT(
      [] { (void)to_continuous(with_A(MatrixXd{{0.5}}), Method::zoh, 3.0); },
      ThrowsMessage<InvalidInput>(HasSubstr("zoh: prewarp is 3 rad/s, expected no prewarping")));
}

}  // namespace
}  // namespace quadtune
