// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/autocovariance_fit.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>

#include "matrix_near.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

const FittedParameter& named(const AutocovarianceFit& fit, const std::string& name) {
  for (const FittedParameter& p : fit.parameters)
    if (p.name == name) return p;
  throw std::runtime_error("no parameter " + name);
}

CovarianceModel one_variance(int parameter) {
  return {MatrixXd::Zero(1, 1), {{MatrixXd::Identity(1, 1), parameter}}, {}};
}

/// The example of Odelson, Rajamani and Rawlings 2006: Q 0.5, R 0.1.
FilterModel three_states() {
  FilterModel m;
  m.name = "three";
  m.dt = 1;
  m.states = {{"a", ""}, {"b", ""}, {"c", ""}};
  m.noises = {{"w", ""}};
  m.A = MatrixXd{{0.1, 0, 0.1}, {0, 0.2, 0}, {0, 0, 0.3}};
  m.B.resize(3, 0);
  m.G = MatrixXd{{1}, {2}, {3}};
  m.parameters = {{"Q.w", "", true, 0.5}, {"R.y", "", true, 0.1}};
  m.Q = one_variance(0);
  FilterSensor& sensor = m.sensors.emplace_back();
  sensor.name = "y";
  sensor.outputs = {{"y", ""}};
  sensor.C = MatrixXd{{0.1, 0.2, 0}};
  sensor.R = one_variance(1);
  m.x0 = VectorXd::Zero(3);
  m.P0 = MatrixXd::Identity(3, 3);
  m.diffuse = {false, false, false};
  return m;
}

/// The local level with a second sensor of the same level.
FilterModel two_sensors() {
  FilterModel m = testing::local_level();
  FilterSensor gps = m.sensors[0];
  gps.name = "gps";
  gps.outputs = {{"position", ""}};
  gps.R.scaled[0].parameter = 2;
  m.sensors.push_back(gps);
  m.parameters.push_back({"R.gps", "", true, 500});
  return m;
}

// P = (1 - m)² P + Q + m² R by hand.
TEST(AutocovarianceFit, ItsTheoryMatchesTheLocalLevelByHand) {
  const double Q = 3, R = 5, m = 0.3;
  const double P = (Q + m * m * R) / (1 - (1 - m) * (1 - m));
  const auto lags = innovation_autocovariances(testing::local_level(), 1, MatrixXd{{m}},
                                               Eigen::Vector2d(std::log(Q), std::log(R)), 5);
  ASSERT_EQ(lags.size(), 6u);
  EXPECT_NEAR(lags[0](0, 0), P + R, 1e-12);
  for (std::size_t j = 1; j < lags.size(); ++j)
    EXPECT_NEAR(lags[j](0, 0), std::pow(1 - m, double(j) - 1) * ((1 - m) * P - m * R), 1e-12);
}

// The covariance of the error as a sum over its past, noise by noise.
TEST(AutocovarianceFit, ItsTheoryMatchesTheSumOverThePast) {
  std::mt19937_64 random(1);
  const FilterModel model = testing::random_model(random, 3, 0, false, true);
  const MatrixXd M = 0.1 * testing::uniform_matrix(3, 3, random);
  const VectorXd theta = start_of(model);
  MatrixXd C(3, 3), R = MatrixXd::Zero(3, 3);
  C << model.sensors[0].C, model.sensors[1].C;
  R.topLeftCorner(1, 1) = covariance(model.sensors[0].R, theta);
  R.bottomRightCorner(2, 2) = covariance(model.sensors[1].R, theta);
  const MatrixXd closed = model.A - model.A * M * C;
  ASSERT_LT(closed.eigenvalues().cwiseAbs().maxCoeff(), 0.99);
  const MatrixXd Q = model.G * covariance(model.Q, theta) * model.G.transpose();
  const auto lags = innovation_autocovariances(model, 0.1, M, theta, 4);
  for (int j = 0; j <= 4; ++j) {
    // e[k] = Σ C closedⁱ⁻¹ (w[k-i] - A M v[k-i]) + v[k].
    MatrixXd sum = j == 0 ? R : MatrixXd::Zero(3, 3);
    MatrixXd late = C, early = C;
    for (int i = 1; i < j; ++i) late = (late * closed).eval();
    if (j > 0) {
      sum -= late * model.A * M * R;
      late = (late * closed).eval();
    }
    for (int i = 0; i < 4000; ++i) {
      sum += late * (Q + model.A * M * R * M.transpose() * model.A.transpose()) * early.transpose();
      late = (late * closed).eval();
      early = (early * closed).eval();
    }
    EXPECT_THAT(lags[static_cast<std::size_t>(j)], MatrixNear(sum, 1e-9)) << j;
  }
}

// Exact autocovariances, computed by the formula, give θ back, whatever the gain.
TEST(AutocovarianceFit, RecoversThetaFromExactAutocovariances) {
  std::mt19937_64 random(2);
  for (const bool full : {false, true})
    for (const bool continuous : {false, true}) {
      const FilterModel truth = testing::random_model(random, 2, 0, continuous, full);
      const MatrixXd M = 0.02 * testing::uniform_matrix(2, 3, random);
      const VectorXd theta = start_of(truth);
      InnovationAutocovariances exact{0.1, M, {}, std::vector<double>(16, 10000)};
      exact.of = innovation_autocovariances(truth, 0.1, M, theta, 15);
      FilterModel model = truth;
      for (NoiseParameter& p : model.parameters) p.start *= p.logarithmic ? 20 : 0.1;
      const AutocovarianceFit fit = fit_autocovariances(model, exact);
      ASSERT_TRUE(fit.solved()) << to_string(fit.status) << " " << fit.culprit;
      EXPECT_THAT(fit.theta, MatrixNear(theta, 1e-5)) << full << continuous;
      EXPECT_LT(fit.misfit, 1e-9);
    }
  const FilterModel level = testing::local_level();
  InnovationAutocovariances exact{1, MatrixXd{{0.4}}, {}, std::vector<double>(2, 100)};
  exact.of = innovation_autocovariances(level, 1, exact.M, Eigen::Vector2d(1, 2), 1);
  const AutocovarianceFit fit = fit_autocovariances(level, exact);
  ASSERT_TRUE(fit.solved());
  EXPECT_THAT(fit.theta, MatrixNear(VectorXd(Eigen::Vector2d(1, 2)), 1e-8));
  EXPECT_EQ(fit.degrees, 0);
}

// 200 logs of the example in the literature: no bias, and errors of the stated size.
TEST(AutocovarianceFit, SolvesTheExampleOfTheLiteratureWithinItsErrors) {
  constexpr int kRuns = 200;
  std::mt19937_64 random(3);
  FilterModel model = three_states();
  const VectorXd truth = start_of(model);
  model.parameters[0].start = 5;
  model.parameters[1].start = 2;
  MatrixXd value(2, kRuns), error(2, kRuns);
  double misfit = 0, degrees = 0;
  for (int run = 0; run < kRuns; ++run) {
    const AutocovarianceFit fit =
        fit_autocovariances(model, {testing::simulated(model, truth, 1000, 1, random)});
    ASSERT_TRUE(fit.solved()) << to_string(fit.status) << " " << fit.culprit;
    for (int i = 0; i < 2; ++i) {
      const FittedParameter& p = fit.parameters[static_cast<std::size_t>(i)];
      ASSERT_EQ(p.verdict, ParameterVerdict::seen) << p.name << " in run " << run;
      value(i, run) = p.value;
      error(i, run) = p.value * p.standard_error;
    }
    misfit += fit.misfit;
    degrees += fit.degrees;
  }
  for (int i = 0; i < 2; ++i) {
    const double mean = value.row(i).mean();
    const double spread = std::sqrt((value.row(i).array() - mean).square().sum() / (kRuns - 1));
    EXPECT_LT(std::abs(mean - std::exp(truth(i))), 3 * spread / std::sqrt(kRuns)) << mean;
    EXPECT_NEAR(error.row(i).mean() / spread, 1, 0.25);
  }
  // χ² of 14 degrees, 200 times.
  EXPECT_NEAR(misfit / degrees, 1, 4 * std::sqrt(2 / degrees));
}

// Two methods, one log: they differ by less than the error of either.
TEST(AutocovarianceFit, AgreesWithTheLikelihood) {
  std::mt19937_64 random(4);
  FilterModel continuous = testing::discrete_altitude();
  continuous.dt = 0;
  continuous.A = MatrixXd{{0, 1}, {0, 0}};
  continuous.B = MatrixXd{{0}, {1}};
  continuous.parameters[0].start = 0.5;
  for (const FilterModel& truth : {testing::discrete_altitude(), continuous}) {
    const VectorXd theta = start_of(truth);
    for (int log = 0; log < 3; ++log) {
      const FilterRecord record = testing::simulated(truth, theta, 6000, 0.005, random);
      FilterModel model = truth;
      for (NoiseParameter& p : model.parameters) p.start *= 5;
      const AutocovarianceFit fit = fit_autocovariances(model, {record});
      const NoiseFit likely = fit_noise(InnovationLikelihood(model, {record}), {.starts = 1});
      ASSERT_TRUE(fit.solved()) << fit.culprit;
      ASSERT_TRUE(likely.converged());
      for (std::size_t i = 0; i < 2; ++i) {
        const double error = likely.parameters[i].standard_error;
        EXPECT_LT(std::abs(fit.theta(Index(i)) - likely.theta(Index(i))), 0.5 * error);
        EXPECT_LT(std::abs(fit.theta(Index(i)) - theta(Index(i))), 4 * error);
        EXPECT_NEAR(fit.parameters[i].standard_error / error, 1, 0.15);
      }
    }
  }
}

// Whatever the initial gain, the last one is computed from the result.
TEST(AutocovarianceFit, DoesNotDependOnTheStart) {
  std::mt19937_64 random(5);
  FilterModel model = testing::discrete_altitude();
  const FilterRecord record = testing::simulated(model, start_of(model), 6000, 0.005, random);
  const AutocovarianceFit near = fit_autocovariances(model, {record});
  ASSERT_TRUE(near.solved());
  for (const auto& [q, r] : {std::pair(1e6, 1.0), {1e-6, 1.0}, {1.0, 1e-6}, {1e-4, 1e-4}}) {
    FilterModel off = model;
    off.parameters[0].start *= q;
    off.parameters[1].start *= r;
    const AutocovarianceFit far = fit_autocovariances(off, {record});
    ASSERT_TRUE(far.solved()) << q << " " << r << far.culprit;
    for (Index i = 0; i < 2; ++i)
      EXPECT_LT(std::abs(far.theta(i) - near.theta(i)), 0.25 * near.parameters[0].standard_error)
          << q << " " << r << " " << i;
  }
}

// Height at every other instant of the input, a position far away, a gap, and a second log.
TEST(AutocovarianceFit, SupportsInputsBetweenMeasurementsGapsAndSeveralLogs) {
  std::mt19937_64 random(6);
  FilterModel model = testing::discrete_altitude();
  const VectorXd truth = start_of(model);
  std::vector<FilterRecord> logs;
  for (int log = 0; log < 2; ++log) {
    FilterRecord record = testing::simulated(model, truth, 12000, 0.005, random);
    for (Index k = 0; k < record.samples(); ++k) {
      record.y(0, k) += 1e5;
      if (k % 2 == 1 || (k > 5000 && k < 5300)) record.y(0, k) = std::nan("");
    }
    logs.push_back(record);
  }
  const AutocovarianceFit fit = fit_autocovariances(model, logs);
  ASSERT_TRUE(fit.solved()) << fit.culprit;
  EXPECT_NEAR(fit.innovation.dt, 0.01, 1e-12);
  EXPECT_GT(fit.samples, 11000);
  EXPECT_LT(fit.samples, 2 * 5851);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT(std::abs(fit.theta(Index(i)) - truth(Index(i))),
              4 * fit.parameters[i].standard_error);
  const NoiseFit likely = fit_noise(InnovationLikelihood(model, logs), {.starts = 1});
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT(std::abs(fit.theta(Index(i)) - likely.theta(Index(i))),
              likely.parameters[i].standard_error);
}

// A random walk with zero variance: the estimate is zero, with an upper bound.
TEST(AutocovarianceFit, ReportsAVarianceOfZero) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 3);
  FilterRecord record;
  record.name = "still";
  record.y.resize(1, 400);
  record.u.resize(0, 400);
  for (int k = 0; k < 400; ++k) record.time.push_back(k);
  int zeros = 0;
  for (int run = 0; run < 20; ++run) {
    for (Index k = 0; k < 400; ++k) record.y(0, k) = 100 + normal(random);
    const AutocovarianceFit fit = fit_autocovariances(testing::local_level(), {record});
    ASSERT_TRUE(fit.solved()) << fit.culprit;
    EXPECT_NEAR(named(fit, "R.y").value, 9, 3);
    const FittedParameter& Q = named(fit, "Q.level");
    if (Q.verdict != ParameterVerdict::at_zero) continue;
    ++zeros;
    EXPECT_EQ(Q.value, 0);
    EXPECT_EQ(Q.low, 0);
    EXPECT_GT(Q.high, 1e-5);
    EXPECT_LT(Q.high, 1);
    EXPECT_TRUE(fit.theta.allFinite());
    EXPECT_LT(std::exp(fit.theta(0)), 1e-9);
  }
  EXPECT_GE(zeros, 6);
  EXPECT_LT(zeros, 20);
}

TEST(AutocovarianceFit, NamesUndeterminedDirections) {
  std::mt19937_64 random(8);
  FilterModel silent = two_sensors();
  FilterRecord record = testing::simulated(silent, start_of(silent), 500, 1, random);
  record.y.row(1).setConstant(std::nan(""));
  const AutocovarianceFit fit = fit_autocovariances(silent, {record});
  ASSERT_TRUE(fit.solved());
  EXPECT_EQ(named(fit, "R.gps").verdict, ParameterVerdict::not_seen);
  EXPECT_NEAR(named(fit, "R.gps").value, 500, 1e-9);
  EXPECT_THAT(fit.unseen, ElementsAre("R.gps: no measurement depends on it"));
  EXPECT_EQ(named(fit, "R.y").verdict, ParameterVerdict::seen);

  // Two noises on one level: their sum is determined.
  FilterModel twin = testing::local_level();
  twin.noises.push_back({"other", ""});
  twin.G = MatrixXd{{1, 1}};
  twin.parameters = {
      {"Q.level", "", true, 500}, {"Q.other", "", true, 500}, {"R.y", "", true, 1e3}};
  twin.Q = {
      MatrixXd::Zero(2, 2), {{MatrixXd{{1, 0}, {0, 0}}, 0}, {MatrixXd{{0, 0}, {0, 1}}, 1}}, {}};
  twin.sensors[0].R = one_variance(2);
  const FilterRecord both = testing::simulated(twin, start_of(twin), 2000, 1, random);
  const AutocovarianceFit sum = fit_autocovariances(twin, {both});
  ASSERT_TRUE(sum.solved()) << sum.culprit;
  EXPECT_THAT(sum.unseen, ElementsAre("only the product of Q.level and Q.other is determined"));
  EXPECT_EQ(named(sum, "Q.level").verdict, ParameterVerdict::combination);
  EXPECT_EQ(named(sum, "Q.other").verdict, ParameterVerdict::combination);
  EXPECT_TRUE(std::isnan(named(sum, "Q.other").standard_error));
  EXPECT_NEAR(named(sum, "Q.level").value + named(sum, "Q.other").value, 1000, 250);
}

TEST(AutocovarianceFit, KeepsFixedParametersAndWeighsPriors) {
  std::mt19937_64 random(9);
  FilterModel model = testing::local_level();
  const FilterRecord record = testing::simulated(model, start_of(model), 2000, 1, random);
  const AutocovarianceFit alone = fit_autocovariances(model, {record});
  model.parameters[1].fixed = true;
  const AutocovarianceFit fixed = fit_autocovariances(model, {record});
  ASSERT_TRUE(fixed.solved());
  EXPECT_EQ(named(fixed, "R.y").verdict, ParameterVerdict::fixed);
  EXPECT_NEAR(named(fixed, "R.y").value, 1000, 1e-9);
  EXPECT_LT(named(fixed, "Q.level").standard_error, named(alone, "Q.level").standard_error);
  model.parameters[1].fixed = false;
  model.parameters[0].prior = NoisePrior{100, 1e-3};
  const AutocovarianceFit told = fit_autocovariances(model, {record});
  ASSERT_TRUE(told.solved());
  EXPECT_NEAR(named(told, "Q.level").value, 100, 1);
  EXPECT_NEAR(named(told, "Q.level").standard_error, 1e-3, 1e-5);
  model.parameters[0].prior = NoisePrior{100, 100};
  const AutocovarianceFit vague = fit_autocovariances(model, {record});
  EXPECT_NEAR(vague.theta(0), alone.theta(0), 0.01);
}

// The profile of the misfit agrees with a brute-force computation.
TEST(AutocovarianceFit, ProfilesTheMisfit) {
  std::mt19937_64 random(10);
  const FilterModel model = testing::local_level();
  const FilterRecord record = testing::simulated(model, start_of(model), 300, 1, random);
  const AutocovarianceFit plain = fit_autocovariances(model, {record});
  const AutocovarianceFit fit = fit_autocovariances(model, {record}, {.profile = true});
  ASSERT_TRUE(fit.solved());
  // The misfit is a parabola in the variance: the centre of the interval is the estimate.
  const FittedParameter& Q = named(fit, "Q.level");
  EXPECT_NEAR(0.5 * (Q.low + Q.high), Q.value, 1e-3 * Q.value);
  EXPECT_NEAR(0.5 * (Q.high - Q.low), 1.959964 * Q.value * Q.standard_error, 1e-3 * Q.value);
  EXPECT_NEAR(std::log(named(plain, "Q.level").high / Q.value), 1.959964 * Q.standard_error, 1e-5);
}

TEST(AutocovarianceFit, ExplainsWhyALogHasNoUniformStretch) {
  std::mt19937_64 random(11);
  // Two sensors, the second at a fifth of the rate.
  FilterModel rates = two_sensors();
  FilterRecord record = testing::simulated(rates, start_of(rates), 1000, 1, random);
  for (Index k = 0; k < 1000; ++k)
    if (k % 5 != 0) record.y(1, k) = std::nan("");
  AutocovarianceFit fit = fit_autocovariances(rates, {record});
  EXPECT_EQ(fit.status, AutocovarianceStatus::no_uniform_stretch);
  EXPECT_THAT(
      fit.culprit,
      StrEq(
          "autocovariances require at least 30 successive samples with a constant sample time and "
          "all measurements in each, which the log does not have: all outputs are measured at the "
          "same instant 200 times (y: y 1000 times, gps: position 200 "
          "times)"));
  EXPECT_TRUE(std::isnan(fit.parameters[0].value));
  EXPECT_EQ(fit.theta, start_of(rates));

  FilterModel moving = testing::discrete_altitude();
  moving.dt = 0;
  const FilterRecord jitter =
      testing::simulated(moving, start_of(moving), 1000, 0.01, random, 0, 0.5);
  fit = fit_autocovariances(moving, {jitter});
  EXPECT_EQ(fit.status, AutocovarianceStatus::no_uniform_stretch);
  EXPECT_THAT(fit.culprit, HasSubstr("of 999 steps from one measurement to the next"));

  const FilterModel level = testing::local_level();
  fit = fit_autocovariances(level, {testing::simulated(level, start_of(level), 25, 1, random)});
  EXPECT_EQ(fit.status, AutocovarianceStatus::no_uniform_stretch);
  FilterRecord nothing = testing::simulated(level, start_of(level), 100, 1, random);
  nothing.y.setConstant(std::nan(""));
  EXPECT_THAT(fit_autocovariances(level, {nothing}).culprit, HasSubstr("nothing is measured"));
}

TEST(AutocovarianceFit, ExplainsUnsupportedModels) {
  std::mt19937_64 random(12);
  // A random walk that is not measured.
  FilterModel blind = testing::local_level();
  blind.states.push_back({"bias", ""});
  blind.A = MatrixXd::Identity(2, 2);
  blind.B.resize(2, 0);
  blind.G = MatrixXd{{1}, {0}};
  blind.sensors[0].C = MatrixXd{{1, 0}};
  blind.x0 = VectorXd::Zero(2);
  blind.P0 = MatrixXd::Identity(2, 2);
  blind.diffuse = {false, false};
  const AutocovarianceFit fit =
      fit_autocovariances(blind, {testing::simulated(blind, start_of(blind), 500, 1, random)});
  EXPECT_EQ(fit.status, AutocovarianceStatus::no_gain);
  EXPECT_THAT(fit.culprit, HasSubstr("bias"));

  FilterModel tails = testing::local_level();
  tails.sensors[0].student = 4;
  const FilterRecord walk = testing::simulated(tails, start_of(tails), 500, 1, random);
  EXPECT_THAT(
      fit_autocovariances(tails, {walk}).culprit,
      StrEq("errors of y have Student's distribution; autocovariances require normal errors"));
  const NoiseFit refused =
      as_noise_fit(fit_autocovariances(tails, {walk}), InnovationLikelihood(tails, {walk}));
  EXPECT_EQ(refused.status, NoiseFitStatus::not_computed);
  EXPECT_THAT(refused.culprit, HasSubstr("Student"));

  FilterRecord changing = walk;
  const MatrixXd one = MatrixXd::Identity(1, 1);
  changing.linearized.assign(500, {one, one, VectorXd::Zero(1), {one}});
  const FilterModel plain = testing::local_level();
  EXPECT_EQ(fit_autocovariances(plain, {changing}).status,
            AutocovarianceStatus::no_uniform_stretch);

  FilterModel level = testing::local_level();
  FilterRecord constant = testing::simulated(level, start_of(level), 100, 1, random);
  constant.y.setConstant(0);
  const AutocovarianceFit still = fit_autocovariances(level, {constant});
  EXPECT_EQ(still.status, AutocovarianceStatus::not_computed);
  EXPECT_THAT(still.culprit,
              HasSubstr("y: y is constant over the fitted part: all 100 measurements are 0; "));
}

TEST(AutocovarianceFit, RejectsBadOptionsAndShapes) {
  const FilterModel level = testing::local_level();
  const auto refused = [](auto&& call, const std::string& message) {
    EXPECT_THAT(call, ThrowsMessage<InvalidInput>(StrEq(message)));
  };
  std::mt19937_64 random(13);
  const FilterRecord record = testing::simulated(level, start_of(level), 100, 1, random);
  refused([&] { (void)fit_autocovariances(level, std::vector<FilterRecord>{}); },
          "logs: there are none; expected at least one");
  refused([&] { (void)fit_autocovariances(level, {record}, {.lags = 0}); },
          "autocovariances: lags is 0, expected at least 1");
  refused([&] { (void)fit_autocovariances(level, {record}, {.passes = 0}); },
          "autocovariances: passes is 0, expected at least 1");
  refused([&] { (void)fit_autocovariances(level, {record}, {.confidence = 0}); },
          "autocovariances: confidence is 0, expected more than 0 and less than 1");
  InnovationAutocovariances given{1, MatrixXd{{0.5}}, {MatrixXd{{1}}}, {100}};
  const auto fit = [&] { (void)fit_autocovariances(level, given); };
  given.M(0, 0) = 2.5;
  refused(fit, "autocovariances: F (I - M C) has a pole at radius 1.5, expected less than 1");
  given.M(0, 0) = 0.5;
  given.pairs = {0};
  refused(fit, "autocovariances: lag 0 has 0 pairs; expected a positive number");
  given.pairs = {};
  refused(fit,
          "autocovariances: 1 autocovariance and 0 numbers of pairs were given, expected one of "
          "each for every lag, beginning with lag 0");
  given.dt = 0.5;
  refused(fit, "autocovariances: the period is 0.5 s, expected a multiple of the model's 1 s");
  given.dt = -1;
  refused(fit, "autocovariances: the period is -1 s, expected a positive number");
  refused(
      [&] {
        (void)innovation_autocovariances(level, 1, MatrixXd{{0.5}}, Eigen::Vector2d(0, 0), -1);
      },
      "autocovariances: lags is -1, expected 0 or more");
}

}  // namespace
}  // namespace quadtune
