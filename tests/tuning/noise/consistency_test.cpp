// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/consistency.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "log_files/nile.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

Consistency of_fit(const FilterModel& model, const std::vector<FilterRecord>& records) {
  const InnovationLikelihood likelihood(model, records);
  const NoiseFit fit = fit_noise(likelihood, {.starts = 1});
  EXPECT_TRUE(fit.converged()) << to_string(fit.status) << " " << fit.culprit;
  std::vector<FilterRun> runs;
  for (std::size_t r = 0; r < records.size(); ++r) runs.push_back(likelihood.run(r, fit.theta));
  return check_consistency(model, runs);
}

/// A vehicle that oscillates vertically: measured height, and vertical acceleration with white
/// noise.
struct Bobbing {
  int samples = 4000;
  double dt = 0.02;
  double vigour = 1;     ///< intensity of its motion
  int delay = 0;         ///< of the measurement, in samples
  double smoothing = 0;  ///< share of the measurement before that is kept
  double colour = 0;     ///< correlation of the measurement's noise from sample to sample
  double offset = 0;     ///< of the acceleration [m/s²]
  double clock = 1;      ///< rate of the clock
  unsigned seed = 1;

  [[nodiscard]] FilterRecord record() const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    FilterRecord r;
    r.name = "bobbing";
    r.y.resize(1, samples);
    r.u.resize(1, samples);
    std::vector<double> heights;
    double z = 0, vz = 0, noise = 0, kept = 0;
    for (int k = 0; k < samples; ++k) {
      const double t = k * dt;
      r.time.push_back(t * clock);
      const double a = vigour * (2 * std::sin(3 * t) + std::sin(7 * t));
      const double felt = a + offset + 0.1 / std::sqrt(dt) * normal(random);
      r.u(0, k) = felt;
      heights.push_back(-z);
      noise = colour * noise + std::sqrt(1 - colour * colour) * 0.01 * normal(random);
      const double seen = heights[static_cast<std::size_t>(std::max(0, k - delay))] + noise;
      kept = k == 0 ? seen : smoothing * kept + (1 - smoothing) * seen;
      r.y(0, k) = kept;
      z += vz * dt + 0.5 * a * dt * dt;
      vz += a * dt;
    }
    return r;
  }
};

TEST(Consistency, PassesDataFromTheModel) {
  const FilterModel model = load_filter_model("altitude");
  int passed = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Consistency c = of_fit(model, {Bobbing{.seed = seed}.record()});
    passed += c.verdict == CheckVerdict::pass;
    if (seed > 1) continue;
    ASSERT_EQ(c.outputs.size(), 1u);
    EXPECT_EQ(c.outputs[0].output, "sonar: height");
    EXPECT_EQ(c.outputs[0].samples, 3998);
    EXPECT_NEAR(c.outputs[0].size, 1, 0.01);  // ensured by the fit
    EXPECT_TRUE(c.reasons.empty());
    EXPECT_EQ(c.checks.size(), 4u);
  }
  EXPECT_GE(passed, 49);
}

TEST(Consistency, DetectsFilteredOrUnmodelledData) {
  const FilterModel model = load_filter_model("altitude");
  const auto reasons = [&](const Bobbing& log) {
    const Consistency c = of_fit(model, {log.record()});
    EXPECT_EQ(c.verdict, CheckVerdict::fail);
    return c.reasons;
  };
  const auto coloured = Contains(HasSubstr("sonar: height: innovations are not white"));
  EXPECT_THAT(reasons({.smoothing = 0.9}), coloured);
  EXPECT_THAT(reasons({.colour = 0.9}), coloured);
  EXPECT_THAT(reasons({.vigour = 20, .delay = 2}), coloured);
  EXPECT_THAT(reasons({.clock = 2}), coloured);
  EXPECT_THAT(reasons({.offset = 1}),
              Contains(HasSubstr("an offset that the model does not contain")));
}

TEST(Consistency, ReportsALogThatIsTooShort) {
  const FilterModel model = load_filter_model("altitude");
  const Consistency c = of_fit(model, {Bobbing{.samples = 60}.record()});
  EXPECT_EQ(c.verdict, CheckVerdict::too_short);
  EXPECT_THAT(c.reasons, Contains("sonar: height: 58 innovations, too few for a verdict"));
  const Consistency some = of_fit(model, {Bobbing{.samples = 200}.record()});
  EXPECT_EQ(some.verdict, CheckVerdict::too_short);
  EXPECT_THAT(some.reasons, Contains(HasSubstr("do not distinguish a correlation of 0.1 from 0")));
}

TEST(Consistency, DetectsWrongCovariances) {
  const FilterModel model = load_filter_model("altitude");
  const FilterRecord record = Bobbing{}.record();
  const InnovationLikelihood likelihood(model, {record});
  const NoiseFit fit = fit_noise(likelihood, {});
  for (const double factor : {0.5, 2.0}) {
    const VectorXd theta = fit.theta.array() + std::log(factor);
    const Consistency c = check_consistency(model, {likelihood.run(0, theta)});
    EXPECT_EQ(c.verdict, CheckVerdict::fail);
    EXPECT_NEAR(c.outputs[0].size, 1 / factor, 0.02);
    EXPECT_THAT(c.reasons, Contains(HasSubstr(factor < 1 ? "the filter is overconfident"
                                                         : "the filter is underconfident")));
  }
}

// One outlier in fifty samples.
TEST(Consistency, DetectsOutliers) {
  FilterRecord record = Bobbing{}.record();
  for (Index k = 25; k < record.samples(); k += 50) record.y(0, k) += 2;
  const Consistency c = of_fit(load_filter_model("altitude"), {record});
  EXPECT_EQ(c.verdict, CheckVerdict::fail);
  EXPECT_THAT(c.reasons, Contains(HasSubstr("as caused by outliers")));
}

// The results agree with their definitions, on synthetic innovations.
TEST(Consistency, StatisticsMatchTheirDefinitions) {
  const FilterModel model = testing::local_level();
  FilterRun run;
  run.status = LikelihoodStatus::computed;
  run.innovation.setConstant(1, 201, std::nan(""));
  run.variance.setConstant(1, 201, 4);
  for (Index k = 0; k < 200; ++k) run.innovation(0, k + (k >= 100)) = k % 2 ? 2 : -2;
  const Consistency c = check_consistency(model, {run}, {.lags = 3});
  const InnovationStatistics& s = c.outputs[0];
  EXPECT_EQ(s.samples, 200);
  EXPECT_EQ(s.mean, 0);
  EXPECT_EQ(s.size, 1);
  EXPECT_EQ(s.kurtosis, -2);
  EXPECT_EQ(s.skewness, 0);
  EXPECT_NEAR(s.autocorrelation(0), -199.0 / 200, 1e-15);
  EXPECT_NEAR(s.autocorrelation(1), 198.0 / 200, 1e-15);
  EXPECT_NEAR(s.ljung_box,
              200.0 * 202 * (199.0 * 199 / 199 + 198.0 * 198 / 198 + 197.0 * 197 / 197) / 40000,
              1e-9);
  EXPECT_LT(s.ljung_box_p, 1e-100);
  EXPECT_EQ(c.verdict, CheckVerdict::fail);
}

TEST(Consistency, RejectsARunThatWasNotComputed) {
  EXPECT_THAT([] { (void)check_consistency(testing::local_level(), {FilterRun{}}); },
              ThrowsMessage<InvalidInput>(
                  StrEq("consistency: a run was not computed; expected innovations")));
  EXPECT_THAT([] { (void)check_consistency(testing::local_level(), {}, {.lags = 0}); },
              ThrowsMessage<InvalidInput>(StrEq("consistency: lags is 0, expected at least 1")));
}

/// A run of a local level with these standardized innovations.
Consistency of_innovations(const std::vector<double>& z) {
  FilterRun run;
  run.status = LikelihoodStatus::computed;
  run.innovation.resize(1, static_cast<Index>(z.size()));
  run.variance.setConstant(1, static_cast<Index>(z.size()), 4);
  for (std::size_t k = 0; k < z.size(); ++k) run.innovation(0, static_cast<Index>(k)) = 2 * z[k];
  return check_consistency(testing::local_level(), {run});
}

std::vector<double> normal_numbers(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> z(count);
  for (double& value : z) value = normal(random);
  return z;
}

// Each large and significant deviation fails, however few the innovations are, and is listed first.
TEST(FewInnovations, FailIfADeviationIsLarge) {
  std::vector<double> alternating = normal_numbers(40, 3);
  for (std::size_t k = 0; k < 40; ++k)
    alternating[k] = (k % 2 == 0 ? 1 : -1) + 0.2 * alternating[k];
  const Consistency correlated = of_innovations(alternating);
  EXPECT_EQ(correlated.verdict, CheckVerdict::fail);
  EXPECT_THAT(correlated.reasons.front(), HasSubstr("innovations are not white: correlation -0.9"));
  EXPECT_THAT(correlated.reasons, Contains("y: y: 40 innovations, too few for a verdict"));

  std::vector<double> wild = normal_numbers(70, 4);
  wild[30] = 30;
  const Consistency outlier = of_innovations(wild);
  EXPECT_GT(outlier.outputs[0].kurtosis, 50);
  EXPECT_EQ(outlier.verdict, CheckVerdict::fail);
  EXPECT_THAT(outlier.reasons, Contains(HasSubstr("innovations are not normal: excess kurtosis")));

  std::vector<double> offset = normal_numbers(20, 5);
  for (double& value : offset) value = 0.3 * value + 1;
  EXPECT_THAT(of_innovations(offset).reasons.front(), HasSubstr("innovations have a mean of 0.9"));

  std::vector<double> large = normal_numbers(10, 6);
  for (double& value : large) value *= 5;
  EXPECT_THAT(of_innovations(large).reasons.front(), HasSubstr("the filter is overconfident"));
  EXPECT_EQ(of_innovations({9}).verdict, CheckVerdict::fail);
}

// For data from the model one in a thousand fails, over all checks together; and none passes.
TEST(FewInnovations, RarelyFailWithTheRightModel) {
  for (const std::size_t count : {2, 7, 12, 30, 99}) {
    int failed = 0;
    for (unsigned seed = 0; seed < 3000; ++seed) {
      const CheckVerdict verdict = of_innovations(normal_numbers(count, seed)).verdict;
      EXPECT_NE(verdict, CheckVerdict::pass);
      failed += verdict == CheckVerdict::fail;
    }
    EXPECT_LE(failed, 10) << count;  // 3 are expected, more than 10 come once in 3,000 times
  }
}

// Values that are not innovations are reported, and none of them is passed to a function that
// throws.
TEST(Consistency, SupportsInvalidNumbers) {
  const double huge = 1e200, none = std::numeric_limits<double>::denorm_min();
  EXPECT_THAT(of_innovations(std::vector<double>(200, 0)).reasons.front(),
              HasSubstr("innovations are 0 times as large as their variance implies"));
  for (const double value : {huge, none, 1.0, -1.0})
    EXPECT_EQ(of_innovations(std::vector<double>(200, value)).verdict, CheckVerdict::fail) << value;
  std::vector<double> one(200, 0);
  one[100] = huge;
  EXPECT_EQ(of_innovations(one).verdict, CheckVerdict::fail);
}

}  // namespace
}  // namespace quadtune
