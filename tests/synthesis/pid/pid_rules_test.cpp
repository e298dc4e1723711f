// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_rules.hpp"

#include <gmock/gmock.h>

#include <complex>
#include <functional>
#include <limits>

#include "numbers.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

using testing::kNaN;
const FopdtModel kModel = {1, 0.5, 0.3};

void expect_standard(const PidGains& gains, double K, double Ti, double Td, double tolerance) {
  const PidStandard standard = standard_form(gains);
  EXPECT_NEAR(standard.K, K, tolerance);
  if (std::isinf(Ti))
    EXPECT_EQ(gains.Ki, 0);
  else
    EXPECT_NEAR(standard.Ti, Ti, tolerance);
  EXPECT_NEAR(standard.Td, Td, tolerance);
}

TEST(PidGains, FormsAreEachOthersInverse) {
  const PidGains gains = parallel_form({2, 4, 0.5, 0.05});
  EXPECT_EQ(gains.Kp, 2);
  EXPECT_EQ(gains.Ki, 0.5);
  EXPECT_EQ(gains.Kd, 1);
  EXPECT_EQ(gains.Tf, 0.05);
  expect_standard(gains, 2, 4, 0.5, 1e-15);
  const std::complex<double> s(0.3, 2);
  EXPECT_LT(std::abs(gains(s) - 2.0 * (1.0 + 1.0 / (4.0 * s) + 0.5 * s / (0.05 * s + 1.0))), 1e-14);
  EXPECT_TRUE(std::isinf(standard_form({2, 0, 0, 0}).Ti));
  EXPECT_THROW((void)standard_form({0, 1, 0, 0}), InvalidInput);
  EXPECT_THROW((void)parallel_form({1, 0, 0, 0}), InvalidInput);
}

TEST(PidGains, RunAsAnElement) {
  const PidSettings<double> settings = pid_settings({2, 3, 0.4, 0.05}, 0.001);
  const DiscreteTransferFunction C = pid_transfer_function(settings, PidChannel::error);
  const PidGains gains = {2, 3, 0.4, 0.05};
  for (double w : {0.1, 1.0, 10.0, 100.0}) {
    const std::complex<double> continuous = gains({0, w});
    const std::complex<double> discrete = C(std::polar(1.0, w * 0.001));
    // Tustin at w is the continuous one at (2/dt) tan(w dt/2): (w dt)²/12 away.
    EXPECT_LT(std::abs(discrete - continuous), 2e-3 * std::abs(continuous)) << w;
  }
  EXPECT_EQ(pid_settings(PidGains{2, 3, 0.4, 0}, 0.001).derivative, PidDerivative::difference);
}

TEST(PidRules, ZieglerNicholsFromTheStep) {
  const double a = 0.3 / 0.5;
  const double kNone = std::numeric_limits<double>::infinity();
  expect_standard(ziegler_nichols_step(PidType::P, kModel), 1 / a, kNone, 0, 1e-14);
  expect_standard(ziegler_nichols_step(PidType::PI, kModel), 0.9 / a, 1.0, 0, 1e-14);
  expect_standard(ziegler_nichols_step(PidType::PID, kModel), 1.2 / a, 0.6, 0.15, 1e-14);
  EXPECT_DOUBLE_EQ(ziegler_nichols_step(PidType::PID, kModel).Tf, 0.015);
  EXPECT_EQ(ziegler_nichols_step(PidType::PID, kModel, kNone).Tf, 0);
}

TEST(PidRules, ZieglerNicholsFromTheLimitOfStability) {
  // 1/(s + 1)³ oscillates at √3 with gain 8.
  const double Tu = 2 * 3.14159265358979324 / std::sqrt(3.0);
  expect_standard(ziegler_nichols_ultimate(PidType::PI, 8, Tu), 3.6, Tu / 1.2, 0, 1e-14);
  expect_standard(ziegler_nichols_ultimate(PidType::PID, 8, Tu), 4.8, Tu / 2, Tu / 8, 1e-14);
  EXPECT_DOUBLE_EQ(ziegler_nichols_ultimate(PidType::P, -8, Tu).Kp, -4);
}

// Åström and Hägglund write the same rule with the relative dead time tau = L/(L + T) and
// coefficients of two or three digits, so that 4/3 becomes 1.35.
TEST(PidRules, CohenCoonInBothOfItsForms) {
  const double L = 0.3;
  const double tau = 0.3 / 0.8;
  const double ratio = tau / (1 - tau);
  const double K = 0.5 / 0.3;
  const double kNone = std::numeric_limits<double>::infinity();
  expect_standard(cohen_coon(PidType::P, kModel), K * (1 + 0.35 * ratio), kNone, 0, 0.03);
  expect_standard(cohen_coon(PidType::PI, kModel), 0.9 * K * (1 + 0.092 * ratio),
                  L * (3.3 - 3 * tau) / (1 + 1.2 * tau), 0, 0.03);
  expect_standard(cohen_coon(PidType::PD, kModel), 1.24 * K * (1 + 0.13 * ratio), kNone,
                  L * (0.27 - 0.36 * tau) / (1 - 0.87 * tau), 0.03);
  expect_standard(cohen_coon(PidType::PID, kModel), 1.35 * K * (1 + 0.18 * ratio),
                  L * (2.5 - 2 * tau) / (1 - 0.39 * tau),
                  L * (0.37 - 0.37 * tau) / (1 - 0.81 * tau), 0.03);
  expect_standard(cohen_coon(PidType::PID, kModel), K * (4.0 / 3 + 0.15),
                  L * (32 + 3.6) / (13 + 4.8), 1.2 / (11 + 1.2), 1e-14);
}

// Numbers calculated by hand from the rule.
TEST(PidRules, Amigo) {
  expect_standard(amigo(PidType::PID, kModel), 0.95, 0.446, 0.127, 5e-4);
  expect_standard(amigo(PidType::PI, kModel), 0.343, 0.469, 0, 5e-4);
  EXPECT_DOUBLE_EQ(amigo(PidType::PID, {-2, 0.5, 0.3}).Kp, -0.475);
}

// Skogestad 2003, example 1: 1/((s + 1)(0.2 s + 1)(0.04 s + 1)(0.008 s + 1)).
TEST(PidRules, SimcOfSkogestadsFirstExample) {
  ContinuousTransferFunction plant;
  plant.num = Eigen::VectorXd::Ones(1);
  plant.den = polynomial_of_roots(Eigen::Vector4cd(-1, -5, -25, -125), 1 / (5.0 * 25 * 125));
  const LagFit<FopdtModel> first = half_rule_fopdt(plant);
  ASSERT_TRUE(first.fitted()) << first.culprit;
  EXPECT_NEAR(first.model.gain, 1, 1e-12);
  EXPECT_NEAR(first.model.time_constant, 1.1, 1e-12);
  EXPECT_NEAR(first.model.delay, 0.148, 1e-12);
  expect_standard(simc(first.model, first.model.delay), 3.72, 1.1, 0, 5e-3);

  const LagFit<SopdtModel> second = half_rule_sopdt(plant);
  ASSERT_TRUE(second.fitted()) << second.culprit;
  EXPECT_NEAR(second.model.time_constant, 1, 1e-12);
  EXPECT_NEAR(second.model.second, 0.22, 1e-12);
  EXPECT_NEAR(second.model.delay, 0.028, 1e-12);
  const PidGains gains = simc(second.model, second.model.delay, 1e9);
  // published in series form: K' = 17.9, Ti' = 0.224, Td' = 0.22
  const std::complex<double> s(0.1, 3);
  const std::complex<double> series = 1 / 0.056 * (1.0 + 1.0 / (0.224 * s)) * (1.0 + 0.22 * s);
  EXPECT_LT(std::abs(gains(s) - series), 1e-7 * std::abs(series));
}

// The model inverted and closed by hand: C = Q/(1 - P Q) with Q = 1/(P's invertible part · filter).
TEST(PidRules, LambdaTuningInvertsTheModel) {
  const double L = 0.3;
  const double T = 0.5;
  const double lambda = 0.4;
  const std::complex<double> s(0.2, 1.5);
  // The plant is right/(left (T s + 1)); the right-half-plane zeros are not inverted.
  const auto controller = [&](std::complex<double> right, std::complex<double> left) {
    const std::complex<double> Q = left * (T * s + 1.0) / (lambda * s + 1.0);
    return Q / (1.0 - right / left / (T * s + 1.0) * Q);
  };
  const double kNone = std::numeric_limits<double>::infinity();
  const std::complex<double> expected = controller(1.0 - L * s, 1);
  const std::complex<double> pid = controller(1.0 - L / 2 * s, 1.0 + L / 2 * s);
  EXPECT_LT(std::abs(lambda_tuning(PidType::PI, kModel, lambda)(s) - expected), 1e-13);
  EXPECT_LT(std::abs(lambda_tuning(PidType::PID, kModel, lambda, kNone)(s) - pid), 1e-13);
}

TEST(PidRules, PiByPoles) {
  const PidGains gains = pi_by_poles(1, 1, 2, 0.7);
  EXPECT_DOUBLE_EQ(gains.Kp, 1.8);
  EXPECT_DOUBLE_EQ(gains.Ki, 4);
  // T s² + (1 + gain Kp) s + gain Ki has the required roots
  const PidGains other = pi_by_poles(-2, 0.3, 5, 0.4);
  const Eigen::VectorXcd roots =
      polynomial_roots(Eigen::Vector3d(0.3, 1 - 2 * other.Kp, -2 * other.Ki));
  for (Eigen::Index i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::abs(roots[i]), 5, 1e-13);
    EXPECT_NEAR(-roots[i].real() / 5, 0.4, 1e-13);
  }
}

TEST(PidRules, RejectUnsupportedInput) {
  EXPECT_THAT([] { (void)amigo(PidType::P, kModel); },
              ThrowsMessage<InvalidInput>(StrEq(
                  "amigo: type is P, expected PI or PID because the rule has no other types")));
  EXPECT_THAT(
      [] {
        (void)ziegler_nichols_step(PidType::PI, {1, 0.5, 0});
      },
      ThrowsMessage<InvalidInput>(StrEq("ziegler_nichols_step: delay is 0 s, expected more "
                                        "than 0 because the rule divides by it")));
  EXPECT_THAT(
      [] {
        (void)cohen_coon(PidType::PD, {1, 0.1, 0.3001});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("expected less than 3")));
  EXPECT_THAT(
      [] {
        (void)lambda_tuning(PidType::PI, {1, -1, 0}, 1);
      },
      ThrowsMessage<InvalidInput>(HasSubstr("time constant is -1 s")));
  const std::function<void()> mistakes[] = {
      [] { (void)amigo(PidType::PI, FopdtModel{}); },
      [] {
        (void)amigo(PidType::PI, {0, 1, 1});
      },
      [] {
        (void)cohen_coon(PidType::PI, {1, kNaN, 1});
      },
      [] { (void)ziegler_nichols_step(PidType::PD, kModel); },
      [] { (void)ziegler_nichols_ultimate(PidType::PD, 1, 1); },
      [] { (void)ziegler_nichols_ultimate(PidType::PI, 0, 1); },
      [] { (void)ziegler_nichols_ultimate(PidType::PI, 1, kNaN); },
      [] { (void)simc(kModel, -0.3); },
      [] {
        (void)simc(SopdtModel{1, 1, -1, 1}, 1);
      },
      [] { (void)lambda_tuning(PidType::P, kModel, 1); },
      [] { (void)lambda_tuning(PidType::PI, kModel, 0); },
      [] { (void)amigo(PidType::PID, kModel, kNaN); },
      [] { (void)pi_by_poles(1, 1, kNaN, 1); },
      [] { (void)pi_by_poles(0, 1, 1, 1); },
  };
  for (const auto& mistake : mistakes) EXPECT_THROW(mistake(), InvalidInput);
}

ContinuousTransferFunction lags(const Eigen::VectorXcd& poles, double delay) {
  ContinuousTransferFunction plant;
  plant.den = polynomial_of_roots(poles);
  plant.num = Eigen::VectorXd::Constant(1, 3 * plant.den[plant.den.size() - 1]);
  plant.delay = delay;
  return plant;
}

TEST(FitFopdt, FindsAModelOfItsOwnForm) {
  for (const double T : {1e-3, 1.0, 200.0}) {
    const LagFit<FopdtModel> fit = fit_fopdt(lags(Eigen::VectorXcd::Constant(1, -1 / T), 0.4));
    ASSERT_TRUE(fit.fitted()) << fit.culprit;
    EXPECT_NEAR(fit.model.gain, 3, 1e-12);
    EXPECT_NEAR(fit.model.time_constant / T, 1, 1e-10);
    EXPECT_NEAR(fit.model.delay, 0.4, 1e-10 * T);
    // The rules that divide by the delay reject 0, not what rounding leaves of it.
    EXPECT_EQ(fit_fopdt(lags(Eigen::VectorXcd::Constant(1, -1 / T), 0)).model.delay, 0) << T;
  }
}

// 1/(s + 1)² steps as 1 - (1 + t) e^(-t).
TEST(FitFopdt, MeetsTheStepResponseAtBothPoints) {
  const LagFit<FopdtModel> fit = fit_fopdt(lags(Eigen::Vector2cd(-1, -1), 0));
  ASSERT_TRUE(fit.fitted()) << fit.culprit;
  const double t63 = fit.model.delay + fit.model.time_constant;
  const double t28 = fit.model.delay + fit.model.time_constant / 3;
  const auto response = [](double t) { return 1 - (1 + t) * std::exp(-t); };
  EXPECT_NEAR(response(t63), 1 - std::exp(-1.0), 1e-12);
  EXPECT_NEAR(response(t28), 1 - std::exp(-1.0 / 3), 1e-12);
}

TEST(FitFopdt, ReportsWhyThereIsNoModel) {
  EXPECT_THAT(fit_fopdt({Eigen::VectorXd::Ones(1), Eigen::Vector2d(1, 0), 0}).culprit,
              StrEq("the pole at 0 is not stable"));
  EXPECT_THAT(fit_fopdt({Eigen::VectorXd::Ones(1), Eigen::Vector3d(1, -0.2, 1), 0}).culprit,
              HasSubstr("0.1 +- 0.995i is not stable"));
  EXPECT_THAT(fit_fopdt({Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1), 0}).culprit,
              HasSubstr("no pole"));
  EXPECT_THAT(fit_fopdt({Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 1), 0}).culprit,
              HasSubstr("gain is 0"));
  EXPECT_THAT(fit_fopdt({Eigen::Vector2d(0.9, 1), Eigen::Vector2d(1, 1), 0}).culprit,
              HasSubstr("jumps"));
  EXPECT_TRUE(
      std::isnan(fit_fopdt({Eigen::Vector2d(0.9, 1), Eigen::Vector2d(1, 1), 0}).model.gain));
  EXPECT_THROW((void)fit_fopdt({}), InvalidInput);
}

// (1 - s/5)/((s + 1)(s/2 + 1)) e^(-0.1 s): the zero is another 0.2 s of delay.
TEST(HalfRule, CountsRightZerosAsDelay) {
  ContinuousTransferFunction plant = lags(Eigen::Vector2cd(-1, -2), 0.1);
  plant.num = Eigen::Vector2d(-2.0 / 5, 2);
  const LagFit<FopdtModel> fit = half_rule_fopdt(plant);
  ASSERT_TRUE(fit.fitted()) << fit.culprit;
  EXPECT_NEAR(fit.model.time_constant, 1.25, 1e-13);
  EXPECT_NEAR(fit.model.delay, 0.1 + 0.25 + 0.2, 1e-13);
}

TEST(HalfRule, ReportsUnsupportedRoots) {
  ContinuousTransferFunction plant = lags(Eigen::Vector2cd(-1, -2), 0);
  plant.num = Eigen::Vector2d(1, 2);
  EXPECT_THAT(half_rule_fopdt(plant).culprit, HasSubstr("zero at -2"));
  plant = {Eigen::VectorXd::Ones(1), Eigen::Vector3d(1, 0.2, 1), 0};
  EXPECT_THAT(half_rule_fopdt(plant).culprit, HasSubstr("which oscillate"));
  EXPECT_THAT(half_rule_sopdt(lags(Eigen::VectorXcd::Constant(1, -1), 0)).culprit,
              HasSubstr("needs two"));
}

}  // namespace
}  // namespace quadtune
