// SPDX-License-Identifier: Apache-2.0
#include "quadtune/transfer_function.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

VectorXd coefficients(std::initializer_list<double> values) {
  return VectorXd::Map(values.begin(), static_cast<Eigen::Index>(values.size()));
}

VectorXd random_vector(Eigen::Index n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(n, [&] { return normal(random); });
}

/// Roots in an order in which two sets can be compared.
std::vector<std::complex<double>> sorted(const VectorXcd& roots) {
  std::vector<std::complex<double>> all(roots.begin(), roots.end());
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::abs(a.real() - b.real()) > 1e-6 ? a.real() < b.real() : a.imag() < b.imag();
  });
  return all;
}

void expect_roots(const VectorXcd& got, const std::vector<std::complex<double>>& expected,
                  double tolerance) {
  ASSERT_EQ(static_cast<std::size_t>(got.size()), expected.size());
  const auto in_order = sorted(got);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LE(std::abs(in_order[i] - expected[i]), tolerance) << in_order[i];
}

TEST(Polynomial, RootsOfClosedForms) {
  expect_roots(polynomial_roots(coefficients({1, -3, 2})), {1, 2}, 1e-14);
  expect_roots(polynomial_roots(coefficients({2, 0, 8})), {{0, -2}, {0, 2}}, 1e-14);
  expect_roots(polynomial_roots(coefficients({0, 0, 4, 2})), {-0.5}, 0);
  expect_roots(polynomial_roots(coefficients({1, 5, 0, 0})), {-5, 0, 0}, 1e-15);
  EXPECT_EQ(polynomial_roots(coefficients({7})).size(), 0);
  EXPECT_THAT(
      [] {
        (void)polynomial_roots(coefficients({0, 0}));
      },
      ThrowsMessage<InvalidInput>(HasSubstr("all coefficients are 0")));
}

TEST(Polynomial, RootsAndBack) {
  std::mt19937_64 random(4);
  for (Eigen::Index n = 1; n <= 12; ++n) {
    const VectorXd p = random_vector(n + 1, random);
    const VectorXd back = polynomial_of_roots(polynomial_roots(p), p[0]);
    EXPECT_THAT(back, testing::MatrixRelativelyNear(MatrixXd(p), 1e-12)) << "degree " << n;
  }
}

TEST(TransferFunction, RealizationHasTheSameResponse) {
  std::mt19937_64 random(5);
  for (Eigen::Index n = 1; n <= 8; ++n)
    for (Eigen::Index zeros = 0; zeros <= n; ++zeros) {
      const ContinuousTransferFunction g{random_vector(zeros + 1, random),
                                         random_vector(n + 1, random)};
      const FrequencyResponse response(realize(g));
      for (const double w : {0.0, 0.01, 0.7, 3.0, 200.0}) {
        const std::complex<double> expected = g({0, w});
        EXPECT_LE(std::abs(response.at(w)(0, 0) - expected),
                  1e-11 * std::max(1.0, std::abs(expected)))
            << "degree " << zeros << "/" << n << " at " << w;
      }
    }
}

// A motor and a body: poles of 1e5 and 1e-2 in one polynomial.
TEST(TransferFunction, RealizationOfFarApartPoles) {
  const ContinuousTransferFunction g{coefficients({3}),
                                     polynomial_of_roots(VectorXcd{{-1e5, -30, -1e-2}})};
  const ContinuousLti plant = realize(g);
  expect_roots(plant.A.eigenvalues(), {-1e5, -30, -1e-2}, 1e-7);
  EXPECT_NEAR(FrequencyResponse(plant).at(0)(0, 0).real() / (3 / (1e5 * 30 * 1e-2)), 1, 1e-13);
}

TEST(TransferFunction, DelayedSamples) {
  const DiscreteTransferFunction g{coefficients({1, 0.5}), coefficients({1, -0.8}), 0.1, 3};
  const DiscreteLti plant = realize(g);
  EXPECT_EQ(plant.A.rows(), 4);
  // The impulse response is that of (z + 0.5)/(z - 0.8), three samples later.
  VectorXd x = VectorXd::Zero(4);
  std::vector<double> y;
  for (int k = 0; k < 6; ++k) {
    const double u = k == 0 ? 1 : 0;
    y.push_back((plant.C * x + plant.D * u)(0));
    x = (plant.A * x + plant.B * u).eval();
  }
  EXPECT_THAT(y, ::testing::ElementsAre(0, 0, 0, 1, 1.3, ::testing::DoubleNear(1.04, 1e-15)));
  const std::complex<double> z = std::polar(1.0, 0.4);
  EXPECT_LE(std::abs(FrequencyResponse(plant).at(4)(0, 0) - g(z)), 1e-14);
}

TEST(TransmissionZeros, AreTheNumerators) {
  std::mt19937_64 random(6);
  for (Eigen::Index n = 1; n <= 7; ++n)
    for (Eigen::Index zeros = 0; zeros <= n; ++zeros) {
      const VectorXd at =
          VectorXd::LinSpaced(n + zeros, -3, 2) + 0.1 * random_vector(n + zeros, random);
      const ContinuousTransferFunction g{
          polynomial_of_roots(at.tail(zeros).cast<std::complex<double>>(), 0.3),
          polynomial_of_roots(at.head(n).cast<std::complex<double>>())};
      const auto expected = sorted(at.tail(zeros).cast<std::complex<double>>());
      ContinuousLti plant = realize(g);
      // In other states, where no entry is 0 any more.
      const MatrixXd T = Eigen::HouseholderQR<MatrixXd>(MatrixXd::NullaryExpr(n, n, [&] {
                           return std::normal_distribution<double>()(random);
                         })).householderQ();
      plant.A = (T.transpose() * plant.A * T).eval();
      plant.B = (T.transpose() * plant.B).eval();
      plant.C = (plant.C * T).eval();
      expect_roots(transmission_zeros(plant, 0, 0), expected, 1e-6);
    }
}

// A chain of lags has no zeros, whatever their speeds and gains.
TEST(TransmissionZeros, OfAChainOfSlowAndFastLagsAreNone) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-2, 2);
  for (Eigen::Index n = 2; n <= 8; ++n)
    for (int i = 0; i < 50; ++i) {
      ContinuousLti plant;
      plant.A = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index k = 0; k < n; ++k) {
        plant.A(k, k) = -std::pow(10, exponent(random));
        if (k + 1 < n) plant.A(k, k + 1) = i % 2 == 0 ? 1 : std::pow(10, exponent(random));
      }
      plant.B = Eigen::VectorXd::Unit(n, n - 1);
      plant.C = Eigen::RowVectorXd::Unit(n, 0);
      EXPECT_EQ(transmission_zeros(plant, 0, 0).size(), 0) << plant.A;
      // With the second state as output as well, one zero: that of 1 + (s + a)/g.
      plant.C(0, 1) = 1;
      const Eigen::VectorXcd one = transmission_zeros(plant, 0, 0);
      ASSERT_EQ(one.size(), 1) << plant.A;
      const double zero = plant.A(0, 0) - plant.A(0, 1);
      EXPECT_NEAR(one[0].real(), zero, 1e-12 * std::abs(zero)) << plant.A;
    }
}

TEST(TransmissionZeros, OfAChannelOfSeveral) {
  // y1 = 1/s u1, y2 = (s + 3)/s u1 + 1/s² u2
  ContinuousLti plant;
  plant.A = MatrixXd::Zero(3, 3);
  plant.A(1, 2) = 1;
  plant.B = MatrixXd::Zero(3, 2);
  plant.B(0, 0) = plant.B(2, 1) = 1;
  plant.C = (MatrixXd(2, 3) << 1, 0, 0, 3, 1, 0).finished();
  plant.D = (MatrixXd(2, 2) << 0, 0, 1, 0).finished();
  expect_roots(transmission_zeros(plant, 1, 0), {-3, 0, 0}, 1e-7);  // what u1 does not reach counts
  EXPECT_EQ(transmission_zeros(plant, 0, 1).size(), 0);
  EXPECT_THAT([&] { (void)transmission_zeros(plant, 2, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("2 inputs and 2 outputs")));
}

TEST(TransferFunction, Refusals) {
  const auto refuses = [](ContinuousTransferFunction g, const std::string& message) {
    EXPECT_THAT([&] { validate(g, "--den"); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  const VectorXd one = coefficients({1});
  const VectorXd two = coefficients({1, 2});
  refuses({{}, two}, "--den: num is empty");
  refuses({one, {}}, "den is empty");
  refuses({one, coefficients({0, 1})}, "the first coefficient of den is 0");
  refuses({coefficients({1, 2, 3}), two}, "num has degree 2, den 1, expected no more zeros");
  refuses({one, coefficients({1, std::nan("")})}, "den has nan");
  refuses({one, two, -1}, "delay is -1 s, expected a finite number >= 0");
  EXPECT_NO_THROW(validate(ContinuousTransferFunction{coefficients({0, 0, 3}), two}, ""));
  EXPECT_THAT(
      [&] {
        (void)realize(ContinuousTransferFunction{one, one});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("den is a constant")));
  EXPECT_THAT(
      [&] {
        validate(DiscreteTransferFunction{one, two, 0}, "g");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("dt is 0 s")));
  EXPECT_THAT(
      [&] {
        validate(DiscreteTransferFunction{one, two, 1, -2}, "g");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("delay is -2 samples")));
}

// By definition, for a plant whose scales are a million apart.
TEST(FrequencyResponse, IsTheDefinition) {
  std::mt19937_64 random(9);
  const auto normal = [&](Eigen::Index r, Eigen::Index c) {
    return MatrixXd::NullaryExpr(r, c, [&] { return std::normal_distribution<double>()(random); });
  };
  for (const Eigen::Index n : {1, 2, 3, 12, 30}) {
    DiscreteLti plant;
    plant.A = normal(n, n);
    plant.B = normal(n, 2);
    plant.C = normal(3, n);
    plant.D = normal(3, 2);
    plant.dt = 0.1;
    plant.A.row(0) *= 1e6;
    plant.A.col(0) *= 1e-6;
    const FrequencyResponse response(plant);
    const std::complex<double> z = std::polar(1.0, 2.0 * 0.1);
    const Eigen::MatrixXcd expected =
        plant.C * (z * MatrixXd::Identity(n, n) - plant.A)
                      .partialPivLu()
                      .solve(plant.B.cast<std::complex<double>>().eval()) +
        plant.D;
    const Eigen::MatrixXcd got = response.at(2.0);
    ASSERT_TRUE(got.allFinite());
    EXPECT_LE((got - expected).norm(), 1e-9 * expected.norm()) << n;
  }
}

}  // namespace
}  // namespace quadtune
