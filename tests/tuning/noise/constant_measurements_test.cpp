// SPDX-License-Identifier: Apache-2.0
#include "noise/constant_measurements.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/nonlinear_filter.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"
#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using internal::constant_measurement;
using ::testing::HasSubstr;

/// This many instants every 0.01 s; inputs 0.
FilterRecord still(const FilterModel& model, Index samples, double value) {
  FilterRecord record{"synthetic",
                      {},
                      MatrixXd::Constant(model.outputs(), samples, value),
                      MatrixXd::Zero(static_cast<Index>(model.inputs.size()), samples)};
  for (Index k = 0; k < samples; ++k) record.time.push_back(0.01 * static_cast<double>(k));
  return record;
}

TEST(ConstantMeasurements, AreNamed) {
  const FilterModel model = load_filter_model("velocity-xy");
  FilterRecord record = still(model, 100, 2);
  record.y(0, 50) = 2.1;
  record.y(1, 3) = std::nan("");
  EXPECT_EQ(constant_measurement(model, {record}),
            "flow: flow_vy is constant over the fitted part: all 99 measurements are 2 m/s; "
            "expected varying ones, because their noise is estimated from them");
  record.y(1, 99) = 2 + 1e-15;
  EXPECT_EQ(constant_measurement(model, {record}), "");
  // It suffices that another stretch has another value; a single measurement does not count as
  // constant.
  FilterRecord other = still(model, 100, 2);
  EXPECT_NE(constant_measurement(model, {other}), "");
  EXPECT_EQ(constant_measurement(model, {other, still(model, 100, 3)}), "");
  other.y.rightCols(99).setConstant(std::nan(""));
  EXPECT_EQ(constant_measurement(model, {other}), "");
}

// A variance that is bounded away from zero independently of the measurements is not rejected.
TEST(ConstantMeasurements, AreAcceptedIfTheirVarianceIsKnown) {
  FilterModel model = load_filter_model("constant-velocity");
  const FilterRecord record = still(model, 100, 2);
  EXPECT_NE(constant_measurement(model, {record}), "");
  model.parameters[1].prior = NoisePrior{0.01, 1};
  EXPECT_EQ(constant_measurement(model, {record}), "");
  model.parameters[1].prior = {};
  model.sensors[0].R.fixed(0, 0) = 1e-4;
  EXPECT_EQ(constant_measurement(model, {record}), "");
  model.sensors[0].R.fixed(0, 0) = 0;
  model.parameters[1].fixed = true;
  EXPECT_EQ(constant_measurement(model, {record}), "");
}

// Through each entry point, for linear and nonlinear models.
TEST(ConstantMeasurements, AreRejectedByEveryFit) {
  const FilterModel model = load_filter_model("constant-velocity");
  const FilterRecord record = still(model, 100, 2);
  const auto says = HasSubstr("position is constant over the fitted part");
  const NoiseFit fit = fit_noise(InnovationLikelihood(model, {record}));
  EXPECT_EQ(fit.status, NoiseFitStatus::not_computed);
  EXPECT_THAT(fit.culprit, says);
  const AutocovarianceFit als = fit_autocovariances(model, {record});
  EXPECT_EQ(als.status, AutocovarianceStatus::not_computed);
  EXPECT_THAT(als.culprit, says);
  const NoiseTuning tuning = tune_noise(model, {record});
  EXPECT_EQ(tuning.verdict, CheckVerdict::fail);
  EXPECT_THAT(tuning.fit.culprit, says);
  for (const char* name : {"inertial", "uquad"}) {
    FilterModel nonlinear = load_filter_model(name);
    FilterRecord one = still(nonlinear, 200, 0);
    if (nonlinear.gravity)
      one.u.row(5).setConstant(9.81);
    else
      one.u.setConstant(300);
    const NoiseTuning refused = tune_noise(*nonlinear_filter(nonlinear, {one}), {});
    EXPECT_EQ(refused.fit.status, NoiseFitStatus::not_computed) << name;
    EXPECT_THAT(refused.fit.culprit, HasSubstr("is constant over the fitted part")) << name;
  }
}

// A straight line is what the model predicts without noise.
TEST(ExactMeasurements, AreNamed) {
  const FilterModel model = load_filter_model("constant-velocity");
  FilterRecord record = still(model, 400, 2);
  for (Index k = 0; k < 400; ++k) record.y(0, k) = 2 + 0.25 * static_cast<double>(k);
  const NoiseTuning tuning = tune_noise(model, {record});
  EXPECT_EQ(tuning.fit.status, NoiseFitStatus::not_computed);
  EXPECT_THAT(tuning.fit.culprit, HasSubstr("position: the model predicts all "));
}

TEST(HangingMeasurements, AreReported) {
  const FilterModel model = load_filter_model("constant-velocity");
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  FilterRecord record = still(model, 1000, 2);
  for (Index k = 0; k < 1000; ++k) record.y(0, k) += 0.1 * normal(random);
  EXPECT_THAT(internal::hanging_measurements(model, {record}), ::testing::IsEmpty());
  FilterRecord stuck = record;
  stuck.y.rightCols(400).setConstant(2.5);
  EXPECT_THAT(internal::hanging_measurements(model, {stuck}),
              ::testing::ElementsAre("position: position is 2.5 m in 400 of 1000 measurements, "
                                     "consecutively from 6 s to 9.99 s: the sensor is stuck, or "
                                     "stationary with a resolution coarser than its noise"));
  // A tuning reports it as a warning, for a person to assess.
  const NoiseTuning tuning = tune_noise(model, {stuck});
  EXPECT_EQ(tuning.warnings.front(), internal::hanging_measurements(model, {stuck}).front());
  // With few quantization steps values repeat by chance.
  FilterRecord coarse = record;
  for (Index k = 0; k < 1000; ++k) coarse.y(0, k) = std::round(4 * coarse.y(0, k)) / 4;
  EXPECT_THAT(internal::hanging_measurements(model, {coarse}), ::testing::IsEmpty());
}

}  // namespace
}  // namespace quadtune
