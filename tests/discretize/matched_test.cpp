// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matched.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

VectorXd list(std::initializer_list<double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.begin(), static_cast<Eigen::Index>(numbers.size()));
}

// (s + 1)/((s + 2)(s + 3)(s + 5)): two zeros at infinity, one of which comes to -1.
TEST(DiscretizeMatched, MapsPolesZerosAndTheGainAtDc) {
  const double dt = 0.1;
  const ContinuousTransferFunction p{list({1, 1}), list({1, 10, 31, 30})};
  const DiscreteTransferFunction d = discretize_matched(p, dt);
  const Eigen::Vector2cd zeros(std::exp(-0.1), -1);
  const Eigen::Vector3cd poles(std::exp(-0.2), std::exp(-0.3), std::exp(-0.5));
  EXPECT_THAT(d.den, MatrixNear(polynomial_of_roots(poles), 1e-14));
  EXPECT_THAT(d.num / d.num[0], MatrixNear(polynomial_of_roots(zeros), 1e-14));
  EXPECT_NEAR(d(1).real(), 1.0 / 30, 1e-14);
}

TEST(DiscretizeMatched, KeepsAllZerosOfAPlantWithFeedthrough) {
  const DiscreteTransferFunction d =
      discretize_matched(ContinuousTransferFunction{list({2, 4}), list({1, 5})}, 0.1);
  const double gain = 0.8 * (1 - std::exp(-0.5)) / (1 - std::exp(-0.2));
  EXPECT_THAT(d.num, MatrixNear(list({gain, -gain * std::exp(-0.2)}), 1e-14));
}

// A zero at DC: the gain is matched at s = 0.1/dt.
TEST(DiscretizeMatched, MatchesTheGainElsewhereWhenDcHasNone) {
  const double dt = 0.01;
  const ContinuousTransferFunction p{list({1, 0}), list({1, 2, 10})};
  const DiscreteTransferFunction d = discretize_matched(p, dt);
  EXPECT_NEAR(d(std::exp(0.1)).real(), p(10).real(), 1e-14);
  EXPECT_NEAR(std::abs(d(1)), 0, 1e-15);
  // A pole at 10 as well: at 0.2/dt then.
  const ContinuousTransferFunction q{list({1, 0}), list({1, -8, -20})};
  EXPECT_NEAR(discretize_matched(q, dt)(std::exp(0.2)).real(), q(20).real(), 1e-13);
}

TEST(DiscretizeMatched, StateSpaceIsTheSamePlant) {
  ContinuousLti p;
  p.A = MatrixXd{{0, 1, 0}, {-10, -2, 1}, {0, 0, -4}};
  p.B = MatrixXd{{0}, {1}, {3}};
  p.C = MatrixXd{{1, 0.5, 0}};
  p.D = MatrixXd{{0.25}};
  p.inputs = {{"w", "rad/s"}};
  p.outputs = {{"z", "m"}};
  const double dt = 0.05;
  const DiscreteLti d = discretize_matched(p, dt);
  EXPECT_EQ(d.A.rows(), 3);
  EXPECT_EQ(d.inputs, p.inputs);
  EXPECT_EQ(d.outputs, p.outputs);
  EXPECT_TRUE(d.states.empty());
  // By the numerator det(sI - A + B C/D) D and the denominator det(sI - A).
  ContinuousTransferFunction same;
  same.den = polynomial_of_roots(p.A.eigenvalues());
  same.num = polynomial_of_roots((p.A - p.B * p.C / 0.25).eigenvalues(), 0.25);
  const DiscreteTransferFunction want = discretize_matched(same, dt);
  for (const double w : {0.1, 3.0, 40.0}) {
    const std::complex<double> z = std::exp(std::complex<double>(0, w * dt));
    const Eigen::MatrixXcd zI = z * Eigen::MatrixXcd::Identity(3, 3);
    const std::complex<double> got =
        (d.C.cast<std::complex<double>>() *
         (zI - d.A).partialPivLu().solve(d.B.cast<std::complex<double>>()))
            .value() +
        d.D(0, 0);
    EXPECT_LT(std::abs(got - want(z)), 1e-11 * std::abs(want(z)));
  }
}

TEST(DiscretizeMatched, NothingStaysNothing) {
  const DiscreteTransferFunction d =
      discretize_matched(ContinuousTransferFunction{list({0, 0}), list({1, 5})}, 0.1);
  EXPECT_EQ(d(0.3), std::complex<double>(0));
}

TEST(DiscretizeMatched, RefusesMoreThanOneChannel) {
  ContinuousLti p;
  p.A = MatrixXd{{-1, 0}, {0, -2}};
  p.B = MatrixXd{{1}, {1}};
  EXPECT_THAT([&] { (void)discretize_matched(p, 0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "matched: the plant has 1 inputs and 2 outputs, expected one of each because "
                  "zeros belong to a channel")));
  p.C = MatrixXd{{1, 0}};
  EXPECT_THAT([&] { (void)discretize_matched(p, -0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr("matched: dt is -0.1 s, expected a positive")));
}

}  // namespace
}  // namespace quadtune
