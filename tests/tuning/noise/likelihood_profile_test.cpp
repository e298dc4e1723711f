// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/likelihood_profile.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "log_files/nile.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// The point at which a profile crosses a level on one side, by interpolation.
double crossing(const LikelihoodProfile& profile, double level, bool upper) {
  const Index n = profile.theta.size();
  for (Index i = 0; i + 1 < n; ++i) {
    const Index a = upper ? n - 1 - i : i, b = upper ? a - 1 : a + 1;
    if (profile.value(a) <= level && profile.value(b) > level)
      return profile.theta(a) + (profile.theta(b) - profile.theta(a)) * (level - profile.value(a)) /
                                    (profile.value(b) - profile.value(a));
  }
  return std::nan("");
}

// It has fallen by half the quantile of χ² at the ends of the profile intervals.
TEST(LikelihoodProfile, CrossesTheLevelOfTheInterval) {
  const InnovationLikelihood likelihood(testing::local_level(), {testing::nile()});
  NoiseFitOptions options;
  options.profile = true;
  const NoiseFit fit = fit_noise(likelihood, options);
  for (int i = 0; i < 2; ++i) {
    const FittedParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    const LikelihoodProfile profile = likelihood_profile(likelihood, fit, i, {.points = 201});
    EXPECT_LE(profile.value.maxCoeff(), 1e-7) << p.name;
    EXPECT_GT(profile.value.maxCoeff(), -1e-3) << p.name;
    EXPECT_NEAR(crossing(profile, -1.920729, false), std::log(p.low), 1e-3) << p.name;
    EXPECT_NEAR(crossing(profile, -1.920729, true), std::log(p.high), 1e-3) << p.name;
  }
}

// The other parameter is optimized: at each point no other value of it is more likely.
TEST(LikelihoodProfile, IsTheMaximumOverTheOthers) {
  const InnovationLikelihood likelihood(testing::local_level(), {testing::nile()});
  const NoiseFit fit = fit_noise(likelihood);
  const LikelihoodProfile profile = likelihood_profile(likelihood, fit, 0, {.points = 5});
  for (Index k = 0; k < 5; ++k) {
    Eigen::VectorXd theta = fit.theta;
    theta(0) = profile.theta(k);
    double best = -1e300;
    for (int step = -800; step <= 800; ++step) {
      theta(1) = fit.theta(1) + 0.01 * step;
      best = std::max(best, likelihood.evaluate(theta).value);
    }
    EXPECT_GE(profile.value(k), best - fit.after.value - 1e-9);
    EXPECT_LT(profile.value(k), best - fit.after.value + 1e-2);
  }
}

// A constant level: its variance is at zero, and the profile ends above the bound.
TEST(LikelihoodProfile, OfAVarianceAtZeroExtendsAboveItsBound) {
  std::mt19937_64 random(4);
  FilterModel model = testing::local_level();
  Eigen::VectorXd truth = start_of(model);
  truth(parameter_index(model, "Q.level", "test")) = -40;
  truth(parameter_index(model, "R.y", "test")) = 0;
  const FilterRecord record = testing::simulated(model, truth, 400, 1, random);
  const InnovationLikelihood likelihood(model, {record});
  const NoiseFit fit = fit_noise(likelihood);
  const int level = parameter_index(model, "Q.level", "test");
  const FittedParameter& p = fit.parameters[static_cast<std::size_t>(level)];
  ASSERT_EQ(p.verdict, ParameterVerdict::at_zero);
  const LikelihoodProfile profile = likelihood_profile(likelihood, fit, level);
  EXPECT_LT(profile.theta(0), std::log(p.high) - 5);
  EXPECT_NEAR(profile.value(0), 0, 0.05);
  EXPECT_LT(profile.value(profile.value.size() - 1), -1.3);
}

TEST(LikelihoodProfile, RejectsAParameterThatWasNotFitted) {
  FilterModel model = testing::local_level();
  model.parameters[1].fixed = true;
  const InnovationLikelihood likelihood(model, {testing::nile()});
  const NoiseFit fit = fit_noise(likelihood);
  EXPECT_THAT([&] { (void)likelihood_profile(likelihood, fit, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("parameter 1 of 2 was not fitted; expected a "
                                                    "fitted")));
  EXPECT_THAT([&] { (void)likelihood_profile(likelihood, fit, 0, {.points = 2}); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected 3 or more")));
}

}  // namespace
}  // namespace quadtune
