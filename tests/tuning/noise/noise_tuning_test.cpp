// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_tuning.hpp"

#include <gmock/gmock.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "matrix_near.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

TEST(LinearizedRecord, HasTheLikelihoodOfItsModel) {
  std::mt19937_64 random(81);
  for (const int nx : {1, 2, 3, 5}) {
    SCOPED_TRACE(nx);
    FilterModel model = testing::random_model(random, nx, 2, false, false);
    model.Q.fixed.setZero();
    const VectorXd theta = start_of(model);
    const FilterRecord record = testing::simulated(model, theta, 60, model.dt, random, 0.2);
    // One period from each instant to the next.
    FilterRecord even = record;
    for (std::size_t k = 0; k < even.time.size(); ++k)
      even.time[k] = static_cast<double>(k) * model.dt;
    const InnovationLikelihood expected(model, {even});
    const InnovationLikelihood got(model, {testing::linearized(model, even)});
    const Likelihood a = expected.evaluate(theta, LikelihoodOrder::information);
    const Likelihood b = got.evaluate(theta, LikelihoodOrder::information);
    ASSERT_TRUE(a.computed() && b.computed());
    EXPECT_NEAR(b.value, a.value, 1e-9 * std::abs(a.value));
    EXPECT_THAT(b.gradient, MatrixNear(a.gradient, 1e-8 * (1 + a.gradient.norm())));
    EXPECT_THAT(b.information, MatrixNear(a.information, 1e-8 * a.information.norm()));
  }
}

TEST(LinearizedRecord, ChangesFromInstantToInstant) {
  // y = c x with a different c at each instant, x a constant known to be 2 ± 0: the likelihood of
  // each is independent.
  FilterModel model = testing::local_level();
  const VectorXd theta = start_of(model);
  FilterRecord record{"synthetic", {0, 1, 2}, MatrixXd(1, 3), MatrixXd(0, 3)};
  record.y << 3, 5, -1;
  record.start = FilterStart{VectorXd::Constant(1, 2), MatrixXd::Zero(1, 1)};
  const double c[] = {1, 2, -1}, f[] = {2, -0.5, 1};
  for (int k = 0; k < 3; ++k)
    record.linearized.push_back({MatrixXd::Constant(1, 1, c[k]),
                                 MatrixXd::Constant(1, 1, f[k]),
                                 VectorXd::Constant(1, k),
                                 {MatrixXd::Zero(1, 1)}});
  const FilterRun run = InnovationLikelihood(model, {record}).run(0, theta);
  // x = 2, then 2 * 2 + 0, then -0.5 * 4 + 1.
  EXPECT_THAT(run.innovation, MatrixNear(Eigen::RowVector3d(3 - 2, 5 - 2 * 4, -1 + -1), 1e-12));
}

TEST(LinearizedRecord, RejectsWrongShapes) {
  const FilterModel model = testing::local_level();
  std::mt19937_64 random(1);
  FilterRecord record =
      testing::linearized(model, testing::simulated(model, start_of(model), 5, 1, random));
  record.linearized.pop_back();
  EXPECT_THAT(
      [&] { validate(record, model, "log"); },
      ThrowsMessage<InvalidInput>(HasSubstr("there are 4 linearized instants, expected 5")));
  record.linearized.push_back(record.linearized.back());
  record.linearized[2].noise.clear();
  EXPECT_THAT([&] { validate(record, model, "log"); },
              ThrowsMessage<InvalidInput>(HasSubstr("an instant has 0 noises, expected 1")));
}

/// A known constant, measured with errors of a heavy-tailed distribution.
TEST(StudentsNoise, HasItsDensity) {
  FilterModel model = testing::local_level();
  model.sensors[0].student = 3.5;
  FilterRecord record{"synthetic", {0, 1, 2, 3}, MatrixXd(1, 4), MatrixXd(0, 4)};
  record.y << 0.3, -2, 11, 0;
  record.start = FilterStart{VectorXd::Zero(1), MatrixXd::Zero(1, 1)};
  VectorXd theta(2);
  theta << -60, std::log(1.7);  // the level is constant
  double expected = 0;
  const boost::math::students_t density(3.5);
  for (const double y : record.y.row(0))
    expected += std::log(boost::math::pdf(density, y / std::sqrt(1.7)) / std::sqrt(1.7));
  const InnovationLikelihood likelihood(model, {record});
  const Likelihood at = likelihood.evaluate(theta, LikelihoodOrder::gradient);
  ASSERT_TRUE(at.computed());
  EXPECT_NEAR(at.value, expected, 1e-12);
}

TEST(StudentsNoise, HasTheSlopeOfItsLikelihood) {
  std::mt19937_64 random(5);
  FilterModel model = testing::random_model(random, 3, 1, true, false);
  model.sensors[0].student = 4;
  const VectorXd theta = start_of(model);
  FilterRecord record = testing::simulated(model, theta, 80, 0.1, random);
  record.y(0, 20) += 30;
  const InnovationLikelihood likelihood(model, {record});
  const Likelihood at = likelihood.evaluate(theta, LikelihoodOrder::gradient);
  ASSERT_TRUE(at.computed());
  for (Index i = 0; i < theta.size(); ++i) {
    const auto moved = [&](double h) {
      VectorXd there = theta;
      there(i) += h;
      return likelihood.evaluate(there).value;
    };
    const double slope =
        (8 * (moved(1e-3) - moved(-1e-3)) - (moved(2e-3) - moved(-2e-3))) / (12 * 1e-3);
    EXPECT_NEAR(at.gradient(i), slope, 1e-7 * (1 + std::abs(slope))) << i;
  }
}

/// The height of table 3.1 with some outliers.
struct Spoilt {
  FilterModel model = testing::discrete_altitude();
  VectorXd truth;
  FilterRecord record;
  Index planted = 0;

  explicit Spoilt(double share, std::uint64_t seed = 11) {
    std::mt19937_64 random(seed);
    truth = start_of(model);
    record = testing::simulated(model, truth, 4000, model.dt, random);
    std::uniform_real_distribution<double> uniform;
    const double deviation = std::exp(0.5 * truth(1));
    for (Index k = 0; k < record.samples(); ++k)
      if (uniform(random) < share) {
        record.y(0, k) +=
            (uniform(random) < 0.5 ? -1 : 1) * deviation * (20 + 20 * uniform(random));
        ++planted;
      }
  }
};

TEST(Gates, RejectTheOutliersOnly) {
  Spoilt spoilt(0.02);
  const NoiseTuning with = tune_noise(spoilt.model, {spoilt.record});
  EXPECT_EQ(with.verdict, CheckVerdict::fail);
  EXPECT_GT(with.fit.parameters[1].low, std::exp(spoilt.truth(1)));  // R is far too large
  spoilt.model.sensors[0].gate = 30;
  const NoiseTuning without = tune_noise(spoilt.model, {spoilt.record});
  ASSERT_EQ(without.refused.size(), 1);
  EXPECT_EQ(without.refused[0].refused, spoilt.planted);
  EXPECT_EQ(without.refused[0].measured, 4000);
  EXPECT_EQ(without.verdict, CheckVerdict::pass)
      << (without.reasons.empty() ? "" : without.reasons[0]);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(without.fit.parameters[static_cast<std::size_t>(i)].low, std::exp(spoilt.truth(i)));
    EXPECT_GT(without.fit.parameters[static_cast<std::size_t>(i)].high, std::exp(spoilt.truth(i)));
  }
}

TEST(Gates, FailIfTheyRejectTooMany) {
  Spoilt spoilt(0.2);
  spoilt.model.sensors[0].gate = 30;
  const NoiseTuning tuning = tune_noise(spoilt.model, {spoilt.record});
  EXPECT_EQ(tuning.verdict, CheckVerdict::fail);
  EXPECT_THAT(tuning.reasons, ::testing::Contains(HasSubstr("too many to be outliers")));
}

TEST(Gates, WorkFromAStartThatWouldRejectEverything) {
  Spoilt spoilt(0.02);
  spoilt.model.sensors[0].gate = 30;
  spoilt.model = with_noise(spoilt.model, spoilt.truth.array() - 12);
  const NoiseTuning tuning = tune_noise(spoilt.model, {spoilt.record});
  EXPECT_EQ(tuning.refused[0].refused, spoilt.planted);
}

// Between the first guess, which is robust to outliers, and the first fit after it.
TEST(Gates, KeepTheFirstGuessWhereTheSearchIsEnded) {
  Spoilt spoilt(0.02);
  spoilt.model.sensors[0].gate = 30;
  spoilt.model = with_noise(spoilt.model, spoilt.truth.array() - 3);
  int asked = 0, end_at = -1, last = 0, first_fit = -1;
  NoiseTuningOptions options;
  options.fit.interrupted = [&] { return asked++ == end_at || (end_at >= 0 && asked > end_at); };
  options.progress = [&](int, int evaluations, double) {
    // the count restarts with the first fit
    if (evaluations < last && first_fit < 0) first_fit = asked;
    last = evaluations;
  };
  (void)tune_noise(spoilt.model, {spoilt.record}, options);
  ASSERT_GT(first_fit, 0);
  end_at = first_fit - 1;
  asked = 0;
  const NoiseTuning ended = tune_noise(spoilt.model, {spoilt.record}, options);
  ASSERT_EQ(ended.fit.status, NoiseFitStatus::interrupted);
  // The distance of the start from the truth is 3, that of the first guess less than 1.
  EXPECT_LT((ended.fit.theta - spoilt.truth).cwiseAbs().maxCoeff(), 1);
}

TEST(Gates, StudentsDistributionIsRobustToo) {
  Spoilt spoilt(0.02);
  spoilt.model.sensors[0].student = 4;
  const NoiseTuning tuning = tune_noise(spoilt.model, {spoilt.record});
  // Their scale is that of the errors without outliers, within a third.
  EXPECT_NEAR(std::log(tuning.fit.parameters[1].value), spoilt.truth(1), 0.3);
}

TEST(Gates, RejectInvalidValues) {
  FilterModel model = testing::local_level();
  model.sensors[0].gate = 3;
  EXPECT_THAT([&] { validate(model, "model"); },
              ThrowsMessage<InvalidInput>(HasSubstr("the gate of sensor 'y' is 3, expected at "
                                                    "least 4")));
  model = testing::local_level();
  model.sensors[0].student = 2;
  EXPECT_THAT([&] { validate(model, "model"); },
              ThrowsMessage<InvalidInput>(HasSubstr("student of sensor 'y' is 2, expected 0, or "
                                                    "more than 2")));
}

}  // namespace
}  // namespace quadtune
