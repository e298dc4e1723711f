// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_fit.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "log_files/nile.hpp"
#include "matrix_near.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

const FittedParameter& parameter_named(const NoiseFit& fit, const std::string& name) {
  for (const FittedParameter& p : fit.parameters)
    if (p.name == name) return p;
  throw std::runtime_error("no parameter " + name);
}

// Durbin and Koopman 2012, section 2.10.3: 15098.52 and 1469.18, from anywhere.
TEST(NoiseFit, FindsTheNilesVariancesFromAnywhere) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> decades(-3, 8);
  for (int start = 0; start < 20; ++start) {
    FilterModel model = testing::local_level();
    for (NoiseParameter& p : model.parameters) p.start = std::pow(10, decades(random));
    NoiseFitOptions options;
    options.starts = 1;
    const NoiseFit fit = fit_noise(InnovationLikelihood(model, {testing::nile()}), options);
    ASSERT_TRUE(fit.converged()) << to_string(fit.status) << model.parameters[0].start << " "
                                 << model.parameters[1].start;
    EXPECT_NEAR(parameter_named(fit, "R.y").value, 15098.518459155015, 1e-3);
    EXPECT_NEAR(parameter_named(fit, "Q.level").value, 1469.1767190775608, 1e-3);
    EXPECT_NEAR(fit.after.value, -632.5456251030405, 1e-9);
    EXPECT_LT(fit.evaluations, 200);
  }
}

TEST(NoiseFit, StandardErrorsMatchTheCurvature) {
  const NoiseFit fit =
      fit_noise(InnovationLikelihood(testing::local_level(), {testing::nile()}), {});
  ASSERT_TRUE(fit.converged());
  const MatrixXd covariance = fit.information.inverse();
  for (Index i = 0; i < 2; ++i) {
    const FittedParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    EXPECT_EQ(p.verdict, ParameterVerdict::seen);
    EXPECT_NEAR(p.standard_error, std::sqrt(covariance(i, i)), 1e-9);
    EXPECT_NEAR(std::log(p.high / p.value), 1.959964 * p.standard_error, 1e-5);
    EXPECT_NEAR(std::log(p.value / p.low), 1.959964 * p.standard_error, 1e-5);
  }
  EXPECT_EQ(fit.agreeing, fit.starts);
  EXPECT_GT(fit.after.value, fit.before.value);
}

// The profile of the likelihood agrees with a brute-force computation.
TEST(NoiseFit, ProfilesTheLikelihood) {
  const InnovationLikelihood likelihood(testing::local_level(), {testing::nile()});
  NoiseFitOptions options;
  options.profile = true;
  const NoiseFit fit = fit_noise(likelihood, options);
  ASSERT_TRUE(fit.converged());
  const auto profile = [&](double Q) {  // the best over a fine grid of R
    double best = -1e9;
    for (int step = 0; step < 2080; ++step) {  // from 5000 to 40,000
      const Eigen::Vector2d theta(std::log(Q), std::log(5000.0) + 1e-3 * step);
      best = std::max(best, likelihood.evaluate(theta).value);
    }
    return best;
  };
  const FittedParameter& Q = parameter_named(fit, "Q.level");
  for (const double edge : {Q.low, Q.high})
    EXPECT_NEAR(profile(edge), fit.after.value - 0.5 * 1.959964 * 1.959964, 1e-4);
  EXPECT_LT(Q.low, Q.value);
  EXPECT_GT(Q.high, Q.value);
}

TEST(NoiseFit, RecoversTheParametersOfALog) {
  std::mt19937_64 random(3);
  for (const bool full : {false, true})
    for (const bool continuous : {false, true}) {
      FilterModel model = testing::random_model(random, 3, 1, continuous, full);
      model.Q.fixed.setZero();
      const VectorXd truth = start_of(model);
      const FilterRecord record = testing::simulated(model, truth, 4000, 0.1, random, 0.1);
      for (NoiseParameter& p : model.parameters)
        if (p.logarithmic) p.start *= 7;
      const NoiseFit fit = fit_noise(InnovationLikelihood(model, {record}), {.starts = 1});
      ASSERT_TRUE(fit.converged()) << to_string(fit.status) << " " << fit.culprit;
      for (Index i = 0; i < truth.size(); ++i) {
        const FittedParameter& p = fit.parameters[static_cast<std::size_t>(i)];
        EXPECT_LT(std::abs(fit.theta(i) - truth(i)), 4 * p.standard_error) << p.name;
        EXPECT_LT(p.standard_error, 1) << p.name;
      }
    }
}

// 100 logs: the 95 % interval contains the true value as often as the binomial distribution allows.
TEST(NoiseFit, ItsIntervalsContainTheTrueValue) {
  std::mt19937_64 random(4);
  const FilterModel model = testing::discrete_altitude();
  const VectorXd truth = start_of(model);
  constexpr int kLogs = 100;
  std::array<int, 2> inside{};
  for (int log = 0; log < kLogs; ++log) {
    const NoiseFit fit = fit_noise(
        InnovationLikelihood(model, {testing::simulated(model, truth, 4000, 0.005, random)}),
        {.starts = 1});
    ASSERT_TRUE(fit.converged());
    for (std::size_t i = 0; i < 2; ++i) {
      const double value = std::exp(truth(static_cast<Index>(i)));
      inside[i] += fit.parameters[i].low < value && value < fit.parameters[i].high;
    }
  }
  // Binomial(100, 0.95): 87 or fewer, or 100, has a probability below 0.01.
  for (const int count : inside) EXPECT_GE(count, 88);
}

// A random walk with zero variance: the estimate is zero, with an upper bound.
TEST(NoiseFit, ReportsAVarianceOfZero) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 3);
  FilterRecord record = testing::nile();
  for (Index k = 0; k < record.samples(); ++k) record.y(0, k) = 100 + normal(random);
  int zeros = 0;
  for (int run = 0; run < 10; ++run) {
    for (Index k = 0; k < record.samples(); ++k) record.y(0, k) = 100 + normal(random);
    const NoiseFit fit = fit_noise(InnovationLikelihood(testing::local_level(), {record}), {});
    ASSERT_TRUE(fit.converged()) << to_string(fit.status);
    const FittedParameter& Q = parameter_named(fit, "Q.level");
    if (Q.verdict != ParameterVerdict::at_zero) continue;
    ++zeros;
    EXPECT_EQ(Q.value, 0);
    EXPECT_EQ(Q.low, 0);
    EXPECT_GT(Q.high, 1e-4);
    EXPECT_LT(Q.high, 9);
    EXPECT_NEAR(parameter_named(fit, "R.y").value, 9, 4);
  }
  // A maximum at zero has the probability 0.66 (Shephard and Harvey 1990).
  EXPECT_GE(zeros, 3);
  EXPECT_LE(zeros, 10);
}

// A sensor without information, and two noises of which only the sum is determined.
TEST(NoiseFit, NamesUndeterminedDirections) {
  std::mt19937_64 random(6);
  FilterModel model = testing::local_level();
  FilterRecord record = testing::simulated(model, start_of(model), 500, 1, random);
  FilterSensor gps = model.sensors[0];
  gps.name = "gps";
  gps.outputs = {{"position", ""}};
  gps.R.scaled[0].parameter = 2;
  model.sensors.push_back(gps);
  model.parameters.push_back({"R.gps", "", true, 5});
  const Eigen::MatrixXd one = record.y;
  record.y.resize(2, one.cols());
  record.y.row(0) = one;
  record.y.row(1).setConstant(std::nan(""));
  const NoiseFit silent = fit_noise(InnovationLikelihood(model, {record}), {});
  ASSERT_TRUE(silent.converged());
  EXPECT_EQ(parameter_named(silent, "R.gps").verdict, ParameterVerdict::not_seen);
  EXPECT_NEAR(parameter_named(silent, "R.gps").value, 5, 1e-12);
  EXPECT_TRUE(std::isnan(parameter_named(silent, "R.gps").standard_error));
  EXPECT_THAT(silent.unseen, ElementsAre("R.gps: no measurement depends on it"));
  EXPECT_EQ(parameter_named(silent, "R.y").verdict, ParameterVerdict::seen);
}

// Prior and log are combined like two measurements of one number.
TEST(NoiseFit, WeighsPriors) {
  FilterModel model = testing::local_level();
  const NoiseFit alone = fit_noise(InnovationLikelihood(model, {testing::nile()}), {});
  model.parameters[0].prior = NoisePrior{100, 0.01};
  const NoiseFit told = fit_noise(InnovationLikelihood(model, {testing::nile()}), {});
  ASSERT_TRUE(told.converged());
  EXPECT_NEAR(parameter_named(told, "Q.level").value, 100, 1);
  EXPECT_NEAR(parameter_named(told, "Q.level").standard_error, 0.01, 1e-4);
  model.parameters[0].prior = NoisePrior{100, 100};
  const NoiseFit vague = fit_noise(InnovationLikelihood(model, {testing::nile()}), {});
  EXPECT_NEAR(parameter_named(vague, "Q.level").value, parameter_named(alone, "Q.level").value, 1);
}

TEST(NoiseFit, KeepsFixedParameters) {
  FilterModel model = testing::local_level();
  model.parameters[1].fixed = true;
  model.parameters[1].start = 12345;
  const InnovationLikelihood likelihood(model, {testing::nile()});
  const NoiseFit fit = fit_noise(likelihood, {});
  ASSERT_TRUE(fit.converged());
  EXPECT_EQ(parameter_named(fit, "R.y").verdict, ParameterVerdict::fixed);
  EXPECT_NEAR(parameter_named(fit, "R.y").value, 12345, 1e-9);
  EXPECT_NEAR(fit.after.gradient(0), 0, 1e-5);
}

TEST(NoiseFit, RejectsTooFewMeasurementsAndBadOptions) {
  FilterRecord record = testing::nile();
  record.time.resize(2);
  record.y = record.y.leftCols(2).eval();
  record.u = record.u.leftCols(2).eval();
  EXPECT_THAT(
      [&] { (void)fit_noise(InnovationLikelihood(testing::local_level(), {record}), {}); },
      ThrowsMessage<InvalidInput>(StrEq(
          "fit: the log has 1 measurement for 2 free parameters, expected at least as many")));
  const InnovationLikelihood likelihood(testing::local_level(), {testing::nile()});
  EXPECT_THAT([&] { (void)fit_noise(likelihood, {.starts = 0}); },
              ThrowsMessage<InvalidInput>(StrEq("fit: starts is 0, expected at least 1")));
  EXPECT_THAT([&] { (void)fit_noise(likelihood, {.confidence = 1}); },
              ThrowsMessage<InvalidInput>(
                  StrEq("fit: confidence is 1, expected more than 0 and less than 1")));
}

// A log-likelihood close to zero, as with these variances, is a sum with rounding errors all the
// same.
TEST(NoiseFit, EndsDespiteRoundingOfItsSum) {
  std::mt19937_64 random(11);
  FilterModel model = testing::local_level();
  const VectorXd truth = (VectorXd(2) << std::log(5.294e-4), std::log(5.294e-2)).finished();
  for (int log = 0; log < (testing::kSanitized ? 6 : 30); ++log) {
    const FilterRecord record = testing::simulated(model, truth, 100'000, 1, random);
    const NoiseFit fit = fit_noise(InnovationLikelihood(model, {record}), {.starts = 1});
    EXPECT_TRUE(fit.converged()) << log << ": " << to_string(fit.status);
    EXPECT_LT(std::abs(fit.after.value), 3000);
  }
}

// One more search if autocovariances have a result, and never a worse end.
TEST(NoiseFit, AlsoStartsAtTheResultOfAutocovariances) {
  std::mt19937_64 random(7);
  FilterModel model = testing::discrete_altitude();
  const FilterRecord uniform = testing::simulated(model, start_of(model), 3000, 0.005, random);
  FilterRecord torn = uniform;
  for (Index k = 0; k < torn.samples(); k += 7) torn.y(0, k) = std::nan("");
  for (NoiseParameter& p : model.parameters) p.start *= 1e5;
  const NoiseFit one = fit_noise(InnovationLikelihood(model, {uniform}), {.starts = 1});
  const NoiseFit two = fit_noise(InnovationLikelihood(model, {uniform}), {.starts = 2});
  EXPECT_EQ(one.starts, 1);
  EXPECT_EQ(two.starts, 3);
  EXPECT_EQ(two.agreeing, 3);
  EXPECT_GE(two.after.value, one.after.value - 1e-6);
  EXPECT_EQ(fit_noise(InnovationLikelihood(model, {torn}), {.starts = 2}).starts, 2);
}

TEST(NoiseFit, StopsWhenAsked) {
  const InnovationLikelihood likelihood(testing::local_level(), {testing::nile()});
  const NoiseFit fit = fit_noise(likelihood, {.starts = 50, .interrupted = [] { return true; }});
  EXPECT_EQ(fit.status, NoiseFitStatus::interrupted);
  EXPECT_EQ(fit.theta, start_of(likelihood.model()));
  EXPECT_EQ(fit.evaluations, 0);
}

// Wherever it is interrupted, in the searches, their long steps, the curvature or the bounds, the
// result is the best point that was evaluated.
TEST(NoiseFit, EndsWithTheBestSoFarWhereverItIsStopped) {
  std::mt19937_64 random(12);
  FilterModel model = testing::discrete_altitude();
  const FilterRecord record = testing::simulated(model, start_of(model), 3000, 0.005, random);
  for (NoiseParameter& p : model.parameters) p.start *= 100;
  const InnovationLikelihood likelihood(model, {record});
  int asked = 0;
  const NoiseFit whole = fit_noise(
      likelihood, {.starts = 2, .profile = true, .interrupted = [&] { return ++asked < 0; }});
  ASSERT_TRUE(whole.converged());
  for (const int max : {1, 2, asked / 8, asked / 4, asked / 2, asked - 1}) {
    SCOPED_TRACE(max);
    int now = 0;
    double best = -std::numeric_limits<double>::infinity();
    const NoiseFit fit =
        fit_noise(likelihood, {.starts = 2,
                               .profile = true,
                               .interrupted = [&] { return ++now > max; },
                               .progress = [&](int, double value) { best = value; }});
    EXPECT_EQ(fit.status, NoiseFitStatus::interrupted);
    if (fit.before.computed()) {
      EXPECT_GE(fit.after.value, fit.before.value);
      EXPECT_NEAR(likelihood.evaluate(fit.theta).value, fit.after.value,
                  1e-9 * std::abs(fit.after.value));
    } else {  // stopped before the first evaluation was complete
      EXPECT_EQ(max, 1);
      EXPECT_EQ(fit.evaluations, 0);
      EXPECT_EQ(fit.theta, start_of(model));
    }
    if (fit.evaluations > 0 && std::isfinite(best)) {
      EXPECT_EQ(fit.after.value, best);
    }
    EXPECT_LT(now, max + 10);  // it does not continue to call
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      EXPECT_EQ(fit.parameters[i].value, std::exp(fit.theta(static_cast<Index>(i))));
      EXPECT_EQ(fit.parameters[i].verdict, ParameterVerdict::not_known);
      EXPECT_TRUE(std::isnan(fit.parameters[i].low));
    }
  }
}

TEST(NoiseFit, IsTheSameOnAnyNumberOfThreads) {
  std::mt19937_64 random(13);
  FilterModel model = testing::random_model(random, 5, 0, false, false);
  const FilterRecord record = testing::simulated(model, start_of(model), 400, 0.1, random, 0.2);
  model.parameters.back().start = 1e-9;
  const InnovationLikelihood likelihood(model, {record});
  const NoiseFit one = fit_noise(likelihood, {.starts = 4, .profile = true, .threads = 1});
  for (const std::size_t threads : {2, 3, 5}) {
    if (testing::kSanitized && threads == 2) continue;
    const NoiseFit many = fit_noise(likelihood, {.starts = 4, .profile = true, .threads = threads});
    EXPECT_EQ(many.theta, one.theta);
    EXPECT_EQ(many.information, one.information);
    EXPECT_EQ(many.evaluations, one.evaluations);
    EXPECT_EQ(many.agreeing, one.agreeing);
    for (std::size_t i = 0; i < one.parameters.size(); ++i) {
      // Two missing values count as equal.
      const auto same = [](double a, double b) { return a == b || (a != a && b != b); };
      EXPECT_TRUE(same(many.parameters[i].low, one.parameters[i].low)) << i;
      EXPECT_TRUE(same(many.parameters[i].high, one.parameters[i].high)) << i;
    }
  }
}

}  // namespace
}  // namespace quadtune
