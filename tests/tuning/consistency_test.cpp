// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/consistency.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "filter_models.hpp"
#include "nile.hpp"
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

/// A vehicle that bobs: height measured, vertical acceleration known with white noise.
struct Bobbing {
  int samples = 4000;
  double dt = 0.02;
  double vigour = 1;     ///< of its motion
  int delay = 0;         ///< of the measurement, in samples
  double smoothing = 0;  ///< share of the measurement before that is kept
  double colour = 0;     ///< correlation of the measurement's noise from sample to sample
  double offset = 0;     ///< of the acceleration [m/s²]
  double clock = 1;      ///< how fast it runs
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

TEST(Consistency, BelievesWhatTheModelMade) {
  const FilterModel model = load_filter_model("altitude");
  int passed = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Consistency c = of_fit(model, {Bobbing{.seed = seed}.record()});
    passed += c.verdict == CheckVerdict::pass;
    if (seed > 1) continue;
    ASSERT_EQ(c.outputs.size(), 1u);
    EXPECT_EQ(c.outputs[0].output, "sonar: height");
    EXPECT_EQ(c.outputs[0].samples, 3998);
    EXPECT_NEAR(c.outputs[0].size, 1, 0.01);  // the fit sees to it
    EXPECT_TRUE(c.reasons.empty());
    EXPECT_EQ(c.checks.size(), 4u);
  }
  EXPECT_GE(passed, 49);
}

TEST(Consistency, NoticesWhatIsNotRawOrNotModelled) {
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
              Contains(HasSubstr("an offset that the model does not know")));
}

TEST(Consistency, SaysWhenALogIsTooShort) {
  const FilterModel model = load_filter_model("altitude");
  const Consistency c = of_fit(model, {Bobbing{.samples = 60}.record()});
  EXPECT_EQ(c.verdict, CheckVerdict::too_short);
  EXPECT_THAT(c.reasons, Contains("sonar: height: 58 innovations, too few to tell"));
  const Consistency some = of_fit(model, {Bobbing{.samples = 200}.record()});
  EXPECT_EQ(some.verdict, CheckVerdict::too_short);
  EXPECT_THAT(some.reasons, Contains(HasSubstr("cannot tell a correlation of 0.1 from none")));
}

TEST(Consistency, SeesCovariancesThatAreWrong) {
  const FilterModel model = load_filter_model("altitude");
  const FilterRecord record = Bobbing{}.record();
  const InnovationLikelihood likelihood(model, {record});
  const NoiseFit fit = fit_noise(likelihood, {});
  for (const double factor : {0.5, 2.0}) {
    const VectorXd theta = fit.theta.array() + std::log(factor);
    const Consistency c = check_consistency(model, {likelihood.run(0, theta)});
    EXPECT_EQ(c.verdict, CheckVerdict::fail);
    EXPECT_NEAR(c.outputs[0].size, 1 / factor, 0.02);
    EXPECT_THAT(c.reasons, Contains(HasSubstr(factor < 1 ? "the filter trusts itself too much"
                                                         : "the filter trusts itself too little")));
  }
}

// One wild echo in fifty.
TEST(Consistency, SeesOutliers) {
  FilterRecord record = Bobbing{}.record();
  for (Index k = 25; k < record.samples(); k += 50) record.y(0, k) += 2;
  const Consistency c = of_fit(load_filter_model("altitude"), {record});
  EXPECT_EQ(c.verdict, CheckVerdict::fail);
  EXPECT_THAT(c.reasons, Contains(HasSubstr("as outliers make")));
}

// Its numbers are those of their definitions, on innovations made by hand.
TEST(Consistency, ComputesWhatItSays) {
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

TEST(Consistency, RefusesWhatIsNotComputed) {
  EXPECT_THAT([] { (void)check_consistency(testing::local_level(), {FilterRun{}}); },
              ThrowsMessage<InvalidInput>(
                  StrEq("consistency: a run came that was not computed, expected innovations")));
  EXPECT_THAT([] { (void)check_consistency(testing::local_level(), {}, {.lags = 0}); },
              ThrowsMessage<InvalidInput>(StrEq("consistency: lags is 0, expected at least 1")));
}

/// Errors of the states of a made-up height whose noise is taken for `times` as large.
ConsistencyCheck error_of_speed(double times) {
  std::mt19937_64 random(31);
  FilterModel model = testing::discrete_altitude();
  const Eigen::VectorXd theta = start_of(model);
  // Whose states are known: what is measured, and a second sensor that tells the truth to a record
  // that no filter sees.
  FilterModel seen = model;
  FilterSensor& speed = seen.sensors.emplace_back();
  speed.name = "truth";
  speed.outputs = {{"speed", "m/s"}};
  speed.C = Eigen::MatrixXd{{0, 1}};
  speed.R.fixed = Eigen::MatrixXd::Constant(1, 1, 1e-18);
  FilterRecord record = testing::simulated(seen, theta, 20000, seen.dt, random);
  record.truth = Eigen::MatrixXd::Constant(2, record.samples(), std::nan(""));
  record.truth.row(1) = record.y.row(1);
  record.y = record.y.topRows(1).eval();
  const Eigen::VectorXd taken = theta.array() + std::log(times);
  const std::vector<FilterRun> runs = {InnovationLikelihood(model, {record}).run(0, taken)};
  const auto checks = check_errors(model, {record}, runs);
  EXPECT_EQ(checks.size(), 1u);
  return checks[0];
}

TEST(ErrorsOfStates, AreWhatTheirCovariancesSay) {
  const ConsistencyCheck right = error_of_speed(1);
  EXPECT_EQ(right.output, "vz");
  EXPECT_EQ(right.verdict, CheckVerdict::pass);
  EXPECT_LT(right.low, right.value);
  EXPECT_GT(right.high, right.value);
  // Errors last for the filter's time constant, so that the band is wide.
  EXPECT_GT(right.high, 1.1);
  const ConsistencyCheck small = error_of_speed(0.2);
  EXPECT_EQ(small.verdict, CheckVerdict::fail);
  EXPECT_NEAR(small.value, 5 * right.value, 0.2 * small.value);
  EXPECT_THAT(small.reason, HasSubstr("vz: the squared error is"));
}

}  // namespace
}  // namespace quadtune
