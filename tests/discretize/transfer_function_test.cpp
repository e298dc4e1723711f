// SPDX-License-Identifier: Apache-2.0
#include "quadtune/transfer_function.hpp"

#include <cmath>
#include <complex>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/discretize/discretize.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;
using Complex = std::complex<double>;
using Method = DiscretizationMethod;

VectorXd as_vector(std::initializer_list<double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.begin(), static_cast<Eigen::Index>(numbers.size()));
}

struct ClosedForm {
  Method method;
  VectorXd num;
  VectorXd den;
};

/// Coefficients within 1e-12 of the largest of num, and of den.
void expect_closed_forms(const ContinuousTransferFunction& plant, double dt,
                         const std::vector<ClosedForm>& forms) {
  for (const ClosedForm& form : forms) {
    const DiscreteTransferFunction d = discretize(plant, dt, form.method);
    EXPECT_THAT(d.num, MatrixNear(form.num, 1e-12 * form.num.cwiseAbs().maxCoeff()))
        << to_string(form.method) << " at " << dt;
    EXPECT_THAT(d.den, MatrixNear(form.den, 1e-12 * form.den.cwiseAbs().maxCoeff()))
        << to_string(form.method) << " at " << dt;
    EXPECT_EQ(d.dt, dt);
    EXPECT_EQ(d.delay, 0);
  }
}

TEST(DiscretizeTransferFunction, FirstOrderLagHasItsClosedForms) {
  const double a = 3, b = 2;
  for (const double dt : {1e-5, 0.01, 0.5, 20.0}) {
    const double p = std::exp(-a * dt);
    const double hold = -std::expm1(-a * dt);  // 1 - p
    const double mean = hold / (a * dt);
    const double h = a * dt / 2;
    const double x = a * dt;
    const VectorXd exact = as_vector({1, -p});
    // Both coefficients of foh are small differences for short samples: by their series.
    const double foh0 = dt < 1e-3 ? x / 2 - x * x / 6 + x * x * x / 24 : 1 - mean;
    const double foh1 = dt < 1e-3 ? x / 2 - x * x / 3 + x * x * x / 8 : mean - p;
    expect_closed_forms({as_vector({b}), as_vector({1, a})}, dt,
                        {{Method::zoh, as_vector({0, b / a * hold}), exact},
                         {Method::foh, as_vector({b / a * foh0, b / a * foh1}), exact},
                         {Method::impulse, as_vector({b * dt, 0}), exact},
                         {Method::euler, as_vector({0, b * dt}), as_vector({1, a * dt - 1})},
                         {Method::backward_euler, as_vector({b * dt / (1 + a * dt), 0}),
                          as_vector({1, -1 / (1 + a * dt)})},
                         {Method::tustin, as_vector({b * dt / 2 / (1 + h), b * dt / 2 / (1 + h)}),
                          as_vector({1, -(1 - h) / (1 + h)})},
                         {Method::matched, as_vector({b / a * hold}), exact}});
  }
}

TEST(DiscretizeTransferFunction, DoubleIntegratorHasItsClosedForms) {
  const double g = 9.81;
  for (const double dt : {1e-5, 0.01, 2.0}) {
    const VectorXd exact = as_vector({1, -2, 1});
    const double T = g * dt * dt;
    expect_closed_forms({as_vector({g}), as_vector({1, 0, 0})}, dt,
                        {{Method::zoh, as_vector({0, T / 2, T / 2}), exact},
                         {Method::foh, as_vector({T / 6, 4 * T / 6, T / 6}), exact},
                         {Method::impulse, as_vector({0, T, 0}), exact},
                         {Method::euler, as_vector({0, 0, T}), exact},
                         {Method::backward_euler, as_vector({T, 0, 0}), exact},
                         {Method::tustin, as_vector({T / 4, T / 2, T / 4}), exact},
                         {Method::matched, as_vector({T / 2, T / 2}), exact}});
  }
}

// From torque to position of a multirotor. The sampled numerator is Euler's: dt⁴/24 (1 11 11 1).
TEST(DiscretizeTransferFunction, FourIntegratorsKeepTheirDigitsAtAnyPeriod) {
  for (const double dt : {1e-6, 1e-3, 0.01, 1.0, 300.0}) {
    const double T = std::pow(dt, 4) / 24;
    expect_closed_forms(
        {as_vector({1}), as_vector({1, 0, 0, 0, 0})}, dt,
        {{Method::zoh, as_vector({0, T, 11 * T, 11 * T, T}), as_vector({1, -4, 6, -4, 1})}});
  }
}

// dt³ is below the range of a double.
TEST(DiscretizeTransferFunction, SurvivesAbsurdlyShortPeriods) {
  const DiscreteTransferFunction d =
      discretize({as_vector({1}), as_vector({1, 0, 0, 0}), 0}, 1e-300, Method::zoh);
  EXPECT_THAT(d.num, MatrixNear(VectorXd::Zero(4), 0));
  EXPECT_THAT(d.den, MatrixNear(as_vector({1, -3, 3, -1}), 0));
}

ContinuousTransferFunction random_fraction(int poles, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  ContinuousTransferFunction plant;
  plant.num = VectorXd::NullaryExpr(poles, draw);
  plant.den = VectorXd::NullaryExpr(poles + 1, draw);
  plant.den[0] = 1;
  return plant;
}

/// Σ cᵢ ((2/h) (z - 1))ⁿ⁻ⁱ (z + 1)ⁱ, degree n.
VectorXd substituted(const VectorXd& c, Eigen::Index n, double h) {
  VectorXd sum = VectorXd::Zero(n + 1);
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    VectorXd term = VectorXd::Constant(1, c[i]);
    const Eigen::Index power = c.size() - 1 - i;
    for (Eigen::Index k = 0; k < n; ++k)
      term = polynomial_product(term, k < power ? as_vector({2 / h, -2 / h}) : as_vector({1, 1}));
    sum += term;
  }
  return sum;
}

// Tustin is a substitution, so the coefficients can be had without any realization.
TEST(DiscretizeTransferFunction, TustinIsTheSubstitution) {
  std::mt19937_64 generator(21);
  const double dt = 0.1;
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % 6;
    const ContinuousTransferFunction p = random_fraction(n, generator);
    for (const double w : {0.0, 12.0}) {
      const DiscreteTransferFunction d =
          w > 0 ? discretize(p, dt, Method::tustin, {.prewarp = w, .delays = {}})
                : discretize(p, dt, Method::tustin);
      const double h = w > 0 ? 2 / w * std::tan(w * dt / 2) : dt;
      const VectorXd den = substituted(p.den, n, h);
      const VectorXd num = substituted(p.num, n, h) / den[0];
      EXPECT_THAT(d.num, MatrixNear(num, 1e-12 * num.cwiseAbs().maxCoeff())) << trial;
      EXPECT_THAT(d.den, MatrixNear(den / den[0], 1e-12 * (den / den[0]).cwiseAbs().maxCoeff()));
    }
  }
}

TEST(DiscretizeTransferFunction, WholeSamplesOfDelayStayDelay) {
  const ContinuousTransferFunction p{as_vector({2}), as_vector({1, 3}), 0.03};
  for (const Method method : {Method::zoh, Method::foh, Method::impulse, Method::euler,
                              Method::backward_euler, Method::tustin, Method::matched}) {
    const DiscreteTransferFunction d = discretize(p, 0.01, method);
    EXPECT_EQ(d.delay, 3) << to_string(method);
    EXPECT_EQ(d.den.size(), 2) << to_string(method);
  }
}

TEST(DiscretizeTransferFunction, AFractionOfDelayIsAPoleAtZeroAndAZero) {
  const double a = 3, b = 2, dt = 0.1, late = 0.03;
  const DiscreteTransferFunction d =
      discretize({as_vector({b}), as_vector({1, a}), 2 * dt + late}, dt, Method::zoh);
  const double now = b / a * -std::expm1(-a * (dt - late));
  const double before = b / a * (std::exp(-a * (dt - late)) - std::exp(-a * dt));
  EXPECT_EQ(d.delay, 2);
  EXPECT_THAT(d.num, MatrixNear(as_vector({0, now, before}), 1e-15));
  EXPECT_THAT(d.den, MatrixNear(as_vector({1, -std::exp(-a * dt), 0}), 1e-15));
}

TEST(DiscretizeTransferFunction, AGainStaysAGain) {
  for (const Method method : {Method::zoh, Method::foh, Method::euler, Method::backward_euler,
                              Method::tustin, Method::matched}) {
    const DiscreteTransferFunction d =
        discretize({as_vector({0, 3}), as_vector({2}), 0.2}, 0.1, method);
    EXPECT_DOUBLE_EQ(d(0.7).real(), 1.5 * std::pow(0.7, -2)) << to_string(method);
  }
  const DiscreteTransferFunction late =
      discretize({as_vector({3}), as_vector({2}), 0.25}, 0.1, Method::zoh);
  EXPECT_EQ(late.delay, 3);
}

TEST(DiscretizeTransferFunction, RefusesWhatHasNoPicture) {
  const auto message = [](const ContinuousTransferFunction& plant, Method method,
                          const std::string& expected, const DiscretizationOptions& options = {}) {
    EXPECT_THAT([&] { (void)discretize(plant, 0.1, method, options); },
                ThrowsMessage<InvalidInput>(HasSubstr(expected)));
  };
  message({as_vector({1, 0, 0}), as_vector({1, 3})}, Method::zoh,
          "zoh: num has degree 2, den 1, expected no more zeros than poles");
  message({as_vector({1, 0}), as_vector({1, 3})}, Method::impulse,
          "impulse: num and den have degree 1, expected fewer zeros than poles");
  message({as_vector({1}), as_vector({1, -20})}, Method::tustin,
          "tustin: A has a pole at 20 1/s, expected none at 2/dt because");
  message({as_vector({1}), as_vector({1, 2}), 0.15}, Method::foh,
          "foh: the delay is 0.15 s, expected a whole number of samples of 0.1 s because");
  message({as_vector({1}), as_vector({1, 2}), 0.15}, Method::matched,
          "matched: the delay is 0.15 s");
  message({as_vector({1}), as_vector({1, 2})}, Method::zoh,
          "zoh: prewarp is 3 rad/s, expected no prewarping", {.prewarp = 3, .delays = {}});
  message({as_vector({1}), as_vector({1, 2})}, Method::zoh, "zoh: delays of channels do not apply",
          {.prewarp = {}, .delays = {VectorXd::Zero(1), {}}});
  EXPECT_THAT(
      [] {
        (void)discretize({as_vector({1}), as_vector({1, 2}), 0}, 0, Method::zoh);
      },
      ThrowsMessage<InvalidInput>(HasSubstr("zoh: dt is 0 s, expected a positive")));
}

}  // namespace
}  // namespace quadtune
