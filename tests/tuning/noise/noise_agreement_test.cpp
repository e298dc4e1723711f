// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_agreement.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "plants/filter_models.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"
#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

NoiseAgreement compared(const FilterModel& model, const FilterRecord& record, NoiseMethod method) {
  const InnovationLikelihood likelihood(model, {record});
  const NoiseFit fit = method == NoiseMethod::likelihood
                           ? fit_noise(likelihood, {.starts = 1})
                           : as_noise_fit(fit_autocovariances(model, {record}), likelihood);
  EXPECT_TRUE(fit.converged()) << fit.culprit;
  return compare_methods(fit, method, likelihood);
}

// For logs from the model both methods agree within less than the upper bound of their distance,
// whichever was used first.
TEST(NoiseAgreement, HoldsIfTheModelIsRight) {
  std::mt19937_64 random(7);
  const FilterModel model = testing::local_level();
  double squares = 0, count = 0;
  for (int log = 0; log < 30; ++log) {
    const FilterRecord record = testing::simulated(model, start_of(model), 1500, 1, random);
    for (const NoiseMethod method : {NoiseMethod::likelihood, NoiseMethod::autocovariances}) {
      const NoiseAgreement agreement = compared(model, record, method);
      EXPECT_EQ(agreement.not_compared, "");
      EXPECT_THAT(agreement.disagreements, IsEmpty());
      ASSERT_THAT(agreement.parameters, SizeIs(2));
      for (const ParameterAgreement& p : agreement.parameters) {
        EXPECT_GE(p.factor, 1);
        squares += p.deviations * p.deviations;
        ++count;
      }
    }
  }
  EXPECT_LT(squares / count, 1);  // they are correlated
}

/// A level that varies slowly in the part in which it is measured at every step, and thirty times
/// as much in the part in which it is measured at every step or every second one: autocovariances
/// use only the first part.
FilterRecord restless(int samples, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  FilterRecord record{"synthetic", {}, MatrixXd(1, samples), MatrixXd(0, samples)};
  double level = 0, time = 0;
  for (int k = 0; k < samples; ++k) {
    const bool late = k >= samples / 2;
    const double step = late && k % 2 == 0 ? 2 : 1;
    time += step;
    level += std::sqrt((late ? 0.3 : 0.01) * step) * normal(random);
    record.time.push_back(time);
    record.y(0, k) = level + normal(random);
  }
  return record;
}

TEST(NoiseAgreement, FailsIfTheModelIsWrong) {
  const NoiseAgreement agreement =
      compared(testing::local_level(), restless(6000, 3), NoiseMethod::likelihood);
  EXPECT_EQ(agreement.other, NoiseMethod::autocovariances);
  ASSERT_FALSE(agreement.disagreements.empty());
  EXPECT_TRUE(agreement.parameters[0].disagrees);
  EXPECT_GT(agreement.parameters[0].factor, 1.5);
  EXPECT_GT(agreement.parameters[0].deviations, 3.5);
  EXPECT_FALSE(agreement.parameters[1].disagrees);  // they agree on the measurement noise
  EXPECT_THAT(agreement.disagreements[0], HasSubstr("by maximum likelihood, and "));
  EXPECT_THAT(agreement.disagreements[0], HasSubstr("its intervals are not valid"));
}

TEST(NoiseAgreement, ExplainsWhyThereIsNoComparison) {
  FilterModel model = testing::local_level();
  model.sensors[0].student = 4;
  std::mt19937_64 random(9);
  const FilterRecord record = testing::simulated(model, start_of(model), 400, 1, random);
  EXPECT_THAT(compared(model, record, NoiseMethod::likelihood).not_compared,
              HasSubstr("have Student's distribution"));
}

// The report of a tuning.
TEST(NoiseAgreement, IsReportedByATuning) {
  const NoiseTuning tuning = tune_noise(testing::local_level(), {restless(6000, 3)});
  ASSERT_TRUE(tuning.agreement);
  EXPECT_EQ(tuning.agreement->disagreements, tuning.warnings);
  EXPECT_THAT(tuning.warnings, ::testing::Not(IsEmpty()));
  NoiseTuningOptions options;
  options.compare = false;
  const NoiseTuning alone = tune_noise(testing::local_level(), {restless(400, 3)}, options);
  EXPECT_FALSE(alone.agreement);
}

}  // namespace
}  // namespace quadtune
