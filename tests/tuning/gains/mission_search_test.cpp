// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/mission_search.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "numbers.hpp"
#include "plants/designed_mambo.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using testing::kInfinity;

FlightSetup short_step(double duration = 4) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("step-north");
  setup.estimator = EstimatorKind::truth;
  setup.real_sensors = false;
  setup.duration = duration;
  return setup;
}

TrialRequest request(std::uint32_t draws = 3) {
  TrialRequest request;
  request.missions = {{"step", short_step(), {{Metric::tilt_max, 1}}}};
  request.cost = {{Metric::speed_max, 1}};
  request.uncertainty.numbers = {{"mass", {DistributionKind::normal, 1, 0.03}}};
  request.draws = draws;
  request.seed = 3;
  return request;
}

/// The designed cascade with the gains of one loop times a factor.
CascadeController scaled(const std::string& loop, double factor) {
  CascadeController controller = testing::designed_mambo_cascade();
  for (PidLoop& one : controller.gains.loops)
    if (one.name == loop) {
      one.Kp *= factor;
      one.Ki *= factor;
      one.Kd *= factor;
    }
  return controller;
}

TEST(PairedDifference, HasStudentsInterval) {
  // R: t.test(c(2, 4, 6, 9), c(1, 2, 3, 4), paired = TRUE)
  const Estimated difference = paired_difference({1, 2, 3, 4}, {2, 4, 6, 9});
  EXPECT_DOUBLE_EQ(difference.value, 2.75);
  EXPECT_NEAR(difference.low, 0.0325, 5e-4);
  EXPECT_NEAR(difference.high, 5.4675, 5e-4);
  EXPECT_THAT(
      [] { (void)paired_difference({1}, {2}); },
      ThrowsMessage<InvalidInput>(HasSubstr("1 and 1 values; expected equal numbers, 2 or more")));
}

TEST(PairedQuantileDifference, OfShiftedValuesIsTheShift) {
  std::mt19937_64 random(3);
  std::exponential_distribution<double> cost(1);
  std::vector<double> first(40), second;
  for (double& c : first) c = cost(random);
  for (const double c : first) second.push_back(c - 2);
  const Estimated difference = paired_quantile_difference(first, second, 0.9);
  EXPECT_NEAR(difference.value, -2, 1e-14);
  EXPECT_NEAR(difference.low, -2, 1e-14);
  EXPECT_NEAR(difference.high, -2, 1e-14);
  EXPECT_EQ(min_draws(0.5), 4);
  EXPECT_EQ(min_draws(0.9), 20);
  EXPECT_EQ(min_draws(0.1), 20);
  EXPECT_EQ(min_draws(0.99), 200);
  EXPECT_EQ(min_draws(kMinTail), 20000);
  first.resize(19);
  second.resize(19);
  EXPECT_THAT([&] { (void)paired_quantile_difference(first, second, 0.9); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("19 and 19 values; expected equal numbers, 20 or more")));
}

// Costs e^(z/2), the second 0.8 times as large, in pairs that share 0.81 of the variance of z: the
// difference of the quantiles is -0.2 e^(z_q/2).
TEST(PairedQuantileDifference, ItsIntervalContainsTheTrueValue) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  constexpr int kTimes = 300;
  const double share = 0.9, truth = -0.2 * std::exp(0.5 * 1.2815515655446004);
  int held = 0, too_good = 0;
  for (int t = 0; t < kTimes; ++t) {
    std::vector<double> first, second;
    for (int i = 0; i < 24; ++i) {
      const double common = 0.9 * normal(random), own = std::sqrt(0.19);
      first.push_back(std::exp(0.5 * (common + own * normal(random))));
      second.push_back(0.8 * std::exp(0.5 * (common + own * normal(random))));
    }
    const Estimated difference = paired_quantile_difference(first, second, share);
    held += static_cast<int>(difference.low <= truth && truth <= difference.high);
    too_good += static_cast<int>(difference.high < truth);
  }
  // Of 300 intervals with 95 % each, at least 273 contain the true value in 99.9 % of all tests;
  // and what is called significantly better is so in 97.5 %.
  EXPECT_GE(held, 273);
  EXPECT_LE(too_good, 17);
}

TEST(MissionTrial, TheReferenceHasAMeanCostOfOne) {
  const CascadeController designed = testing::designed_mambo_cascade();
  const MissionTrial trial(request(), designed, 1);
  const TrialOutcome outcome = trial.fly(designed);
  ASSERT_EQ(outcome.costs.size(), 3);
  EXPECT_NEAR(outcome.cost, 1, 1e-12);
  EXPECT_EQ(outcome.failed, 0);
  // Draws differ from each other and are reproducible.
  EXPECT_NE(outcome.costs[0], outcome.costs[1]);
  EXPECT_EQ(trial.fly(designed).costs, outcome.costs);
  // A draw does not depend on the other draws.
  EXPECT_EQ(trial.fly(designed, 2, 1).costs[0], outcome.costs[2]);
}

TEST(MissionTrial, MeasuresDraws) {
  TrialRequest asked = request(5);
  const CascadeController designed = testing::designed_mambo_cascade();
  const std::vector<double> costs = MissionTrial(asked, designed, 1).fly(designed).costs;
  asked.measure = RobustMeasure::worst;
  EXPECT_EQ(MissionTrial(asked, designed, 1).fly(designed).cost,
            *std::max_element(costs.begin(), costs.end()));
  asked.measure = RobustMeasure::quantile;
  asked.share = 0.5;
  std::vector<double> sorted = costs;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(MissionTrial(asked, designed, 1).fly(designed).cost, sorted[2]);
}

TEST(MissionTrial, AFlightThatEndsEarlyIsExpensiveAndExceedsAllLimits) {
  const CascadeController designed = testing::designed_mambo_cascade();
  const MissionTrial trial(request(), designed, 1);
  const TrialOutcome outcome = trial.fly(scaled("pitch", -1));
  EXPECT_EQ(outcome.failed, 3);
  EXPECT_GT(outcome.cost, MissionTrial::kFailure);
  ASSERT_EQ(outcome.limits.size(), 1);
  EXPECT_EQ(outcome.limits[0].value, kInfinity);
  EXPECT_EQ(outcome.limits[0].excess(), 2);
  EXPECT_FALSE(outcome.satisfies_limits());
}

TEST(TrialLimit, ExcessIsAShareOfTheLimit) {
  const TrialLimit kept{"m", Metric::tilt_max, 0.4, 0.5}, passed{"m", Metric::tilt_max, 0.6, 0.5};
  EXPECT_NEAR(kept.excess(), -0.2, 1e-15);
  EXPECT_NEAR(passed.excess(), 0.2, 1e-15);
  const DesignLimit margin{"phase", 30, 40, true}, peak{"Ms", 1.5, 1.4, false};
  EXPECT_NEAR(margin.excess(), 0.25, 1e-15);
  EXPECT_NEAR(peak.excess(), 0.1 / 1.4, 1e-15);
  EXPECT_EQ((DesignLimit{"Ms", std::nan(""), 1.4, false}.excess()), 2);
  EXPECT_EQ((DesignLimit{"delay", kInfinity, 0.1, true}.excess()), -1);
  // No Ms is below 1: 1.38 leaves a twentieth of the distance to 1.4.
  EXPECT_NEAR((DesignLimit{"Ms", 1.38, 1.4, false, 1}.excess()), -0.05, 1e-15);
}

// A design exactly at the limit, as by `quadtune pid --Ms-max`, satisfies it.
TEST(TrialLimit, RoundingDoesNotExceedALimit) {
  TrialOutcome outcome;
  outcome.limits = {{"m", Metric::tilt_max, 0.5 + 1e-7, 0.5}};
  EXPECT_TRUE(outcome.satisfies_limits());
  outcome.limits[0].value = 0.501;
  EXPECT_FALSE(outcome.satisfies_limits());
}

// Regression test: large violations of different sizes were indistinguishable.
TEST(TrialLimit, ExcessIsMonotone) {
  double before = -2;
  for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 5.0, 100.0}) {
    EXPECT_GT(excess_of(share), before) << share;
    before = excess_of(share);
  }
  EXPECT_GT(excess_of(kInfinity), before);
  EXPECT_EQ(excess_of(std::nan("")), excess_of(kInfinity));
}

TEST(MissionTrial, AMissingMetricOfTheReferenceIsPenalized) {
  TrialRequest asked = request(2);
  asked.missions[0] = {"landing", short_step(), {}};
  asked.missions[0].setup.mission = load_mission("take-off-and-land");
  asked.missions[0].setup.duration = 0;
  asked.cost = {{Metric::touchdown_speed, 1}};
  const CascadeController designed = testing::designed_mambo_cascade();
  const MissionTrial trial(asked, designed, 1);
  EXPECT_NEAR(trial.fly(designed).cost, 1, 1e-12);
  // Without weight on the altitude it stays up and never touches the ground.
  CascadeController hovering = designed;
  for (PidLoop& loop : hovering.gains.loops)
    if (loop.name == "altitude") loop.Kp = loop.Ki = 0;
  const TrialOutcome outcome = trial.fly(hovering);
  EXPECT_EQ(outcome.failed, 0);
  for (const double cost : outcome.costs) EXPECT_GE(cost, MissionTrial::kFailure);
}

TEST(MissionTrial, StopsWhenAsked) {
  const CascadeController designed = testing::designed_mambo_cascade();
  const auto stop = [] { return true; };
  EXPECT_THROW(MissionTrial(request(), designed, 1, stop), Interrupted);
  const MissionTrial trial(request(), designed, 1);
  EXPECT_THROW((void)trial.fly(designed, stop), Interrupted);
}

TEST(MissionTrial, RejectsInvalidRequests) {
  const CascadeController designed = testing::designed_mambo_cascade();
  const auto refuses = [&](const TrialRequest& asked, const std::string& message) {
    EXPECT_THAT([&] { MissionTrial trial(asked, designed, 1); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  TrialRequest asked = request();
  asked.missions.clear();
  refuses(asked, "there is no mission");
  asked = request();
  asked.draws = 0;
  refuses(asked, "there are 0 draws");
  asked = request();
  asked.share = 0.99999;
  refuses(asked, "the quantile is 0.99999, expected from 0.0001 to 0.9999");
  asked = request();
  asked.cost = {{Metric::energy, 0}};
  refuses(asked, "the cost has no weight");
  asked = request();
  asked.cost = {{Metric::energy, -1}};
  refuses(asked, "the weight of energy is -1");
  asked = request();
  asked.cost = {{Metric::touchdown_speed, 1}};
  refuses(asked, "mission 'step': its flight of 4 s yields none of the metrics of the cost (");
  asked = request();
  asked.uncertainty.numbers = {{"vision_noise", {DistributionKind::normal, 1, 0.1}}};
  refuses(asked, "vision_noise");
}

/// The loops of x and y scaled by e^x; the designed gains are at 0.
DesignSpace space(double start) {
  DesignSpace space;
  space.names = {"x", "y"};
  space.start = Eigen::Vector2d::Constant(start);
  space.point = [](const Eigen::VectorXd& x) {
    CascadeController controller = scaled("x", std::exp(x(0)));
    for (PidLoop& loop : controller.gains.loops)
      if (loop.name == "y") loop.Kp *= std::exp(x(1));
    DesignPoint point;
    point.controller = controller;
    point.limits = {{"x within", x(0), 0.5, false}};
    return point;
  };
  return space;
}

TrialRequest tracking() {
  TrialRequest asked = request();
  asked.cost = {{Metric::tracking_max, 1}};
  asked.missions[0].setup = short_step(14);
  return asked;
}

TEST(MissionSearch, FindsBetterGainsAndProvesThem) {
  const DesignSpace sluggish = space(-1.2);
  const MissionTrial trial(tracking(), *sluggish.point(sluggish.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 120;
  options.proof_draws = 6;
  double before = kInfinity;
  int calls = 0;
  options.progress = [&](double best, int, double) {
    // decreases monotonically among points that satisfy the limits
    EXPECT_LE(best, before * (1 + 1e-12) + 20);
    before = best;
    ++calls;
  };
  const MissionSearchResult result = search_missions(sluggish, trial, options);
  EXPECT_GT(calls, 10);
  EXPECT_TRUE(result.accepted) << result.reason;
  EXPECT_LT(result.difference.high, 0);
  EXPECT_LT(result.after.cost, result.before.cost);
  EXPECT_LE(result.best(0), 0.5 + 1e-6);  // the limit is satisfied
  EXPECT_LE(result.evaluations, 120);
  // Reproducible.
  options.progress = {};
  EXPECT_EQ(search_missions(sluggish, trial, options).best, result.best);
}

TEST(MissionSearch, AQuantileIsProvedByItsOwnInterval) {
  const DesignSpace sluggish = space(-1.2);
  TrialRequest asked = tracking();
  asked.measure = RobustMeasure::quantile;
  asked.share = 0.75;
  const MissionTrial trial(asked, *sluggish.point(sluggish.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 60;
  options.proof_draws = 8;
  const MissionSearchResult result = search_missions(sluggish, trial, options);
  EXPECT_TRUE(result.accepted) << result.reason;
  EXPECT_THAT(result.reason, HasSubstr("on 8 fresh draws the 0.75 quantile of its cost is "));
  const Estimated difference =
      paired_quantile_difference(result.proof_before.costs, result.proof_after.costs, 0.75);
  EXPECT_EQ(result.difference.value, difference.value);
  EXPECT_EQ(result.difference.high, difference.high);
  EXPECT_NEAR(result.less, -100 * difference.value / result.proof_before.cost, 1e-12);
  options.proof_draws = 7;
  EXPECT_THAT([&] { (void)search_missions(sluggish, trial, options); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "7 fresh draws are too few for the 0.75 quantile, expected at least 8")));
}

TEST(MissionSearch, ALimitBinds) {
  DesignSpace bound = space(-1.2);
  bound.point = [inner = bound.point](const Eigen::VectorXd& x) {
    DesignPoint point = inner(x);
    point.limits = {{"x within", x(0), -1, false}};
    return point;
  };
  const MissionTrial trial(tracking(), *bound.point(bound.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 150;
  options.proof_draws = 6;
  const MissionSearchResult result = search_missions(bound, trial, options);
  EXPECT_TRUE(result.accepted) << result.reason;
  EXPECT_LE(result.best(0), -1 + 1e-6);
  EXPECT_GT(result.best(0), -1.1);  // and reached up to a share of 0.01
  EXPECT_THAT(result.binding, ElementsAre("x within"));
  // The optimum with a bound that is looser by a tenth of its size.
  ASSERT_EQ(result.buys.size(), 1U);
  Eigen::VectorXd looser = result.best;
  looser(0) += 0.1;
  const double cost = trial.fly(*bound.point(looser).controller).cost;
  const double bought = 100 * (1 - cost / result.after.cost);
  EXPECT_GT(result.buys[0], 1);
  EXPECT_NEAR(result.buys[0], bought, 0.3 * bought);
}

// A limit that the start exceeds is penalized below the value of the start, too.
TEST(MissionSearch, PricesALimitThatTheStartExceeds) {
  DesignSpace bound = space(-0.6);
  bound.point = [inner = bound.point](const Eigen::VectorXd& x) {
    DesignPoint point = inner(x);
    point.limits = {{"x within", x(0), -1, false}};
    return point;
  };
  const MissionTrial trial(tracking(), *bound.point(bound.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 150;
  options.proof_draws = 6;
  const MissionSearchResult result = search_missions(bound, trial, options);
  ASSERT_THAT(result.binding, ElementsAre("x within"));
  Eigen::VectorXd looser = result.candidate;
  looser(0) += 0.1;
  const double cost = trial.fly(*bound.point(looser).controller).cost;
  const double bought = 100 * (1 - cost / result.after.cost);
  ASSERT_GT(bought, 1);
  ASSERT_EQ(result.buys.size(), 1U);
  EXPECT_NEAR(result.buys[0], bought, 0.2 * bought);
}

TEST(MissionSearch, ReportsABindingLimitWithoutEffectOnTheCost) {
  // Of two binding limits, only one affects the cost.
  DesignSpace bound = space(-1.2);
  bound.point = [inner = bound.point](const Eigen::VectorXd& x) {
    DesignPoint point = inner(x);
    point.limits = {{"x within", x(0), -1, false}, {"always met", 1, 1 / 0.99, false}};
    return point;
  };
  const MissionTrial trial(tracking(), *bound.point(bound.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 150;
  options.proof_draws = 6;
  const MissionSearchResult result = search_missions(bound, trial, options);
  ASSERT_THAT(result.binding, ElementsAre("x within", "always met"));
  ASSERT_EQ(result.buys.size(), 2U);
  EXPECT_GT(result.buys[0], 1);
  EXPECT_LT(result.buys[1], 1e-6);
}

// Regression test: points farther inside the limits were preferred whatever their cost.
TEST(MissionSearch, ALimitAtTheStartDoesNotAttractTheSearch) {
  DesignSpace tight = space(-1.2);
  tight.point = [inner = tight.point](const Eigen::VectorXd& x) {
    DesignPoint point = inner(x);
    point.limits.assign(6, {"tight", 1 + 0.2 * (x(0) + 1.2), 1 + 1e-6, false});
    return point;
  };
  const MissionTrial trial(tracking(), *tight.point(tight.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 60;
  options.proof_draws = 3;
  const MissionSearchResult result = search_missions(tight, trial, options);
  ASSERT_EQ(std::ssize(result.steps), result.evaluations);
  for (const SearchStep& step : result.steps) EXPECT_LE(step.best, result.before.cost);
  EXPECT_LE(result.after.cost, result.before.cost);
}

TEST(MissionSearch, PrefersPointsThatSatisfyTheLimits) {
  // The start exceeds a limit by far, and points that satisfy it cost more.
  DesignSpace passed = space(0);
  passed.point = [inner = passed.point](const Eigen::VectorXd& x) {
    DesignPoint point = inner(x);
    point.limits = {{"x within", 10 + 10 * x(0), 1, false}};
    return point;
  };
  const MissionTrial trial(tracking(), *passed.point(passed.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 150;
  options.proof_draws = 4;
  const MissionSearchResult result = search_missions(passed, trial, options);
  EXPECT_TRUE(result.accepted) << result.reason;
  EXPECT_LE(result.best(0), -0.9);
  EXPECT_THAT(result.reason, HasSubstr("it satisfies all limits, and the start does not"));
  EXPECT_THAT(result.broken, ElementsAre());
  // If no point can satisfy it, the result says so, and it is not exceeded by more.
  passed.reach = 0.3;
  const MissionSearchResult still = search_missions(passed, trial, options);
  EXPECT_LE(still.best(0), 0);
  EXPECT_LE(still.candidate(0), 0);
  EXPECT_THAT(still.broken, ElementsAre("x within"));
}

TEST(MissionSearch, NeverReturnsAnythingWorse) {
  // All other points are unstable.
  DesignSpace alone = space(0);
  alone.point = [inner = alone.point](const Eigen::VectorXd& x) {
    DesignPoint point = inner(x);
    if (!x.isZero(0)) point.controller = scaled("pitch", -1);
    return point;
  };
  const MissionTrial trial(tracking(), *alone.point(alone.start).controller, 2);
  MissionSearchOptions options;
  options.evaluations = 30;
  const MissionSearchResult result = search_missions(alone, trial, options);
  EXPECT_FALSE(result.accepted);
  EXPECT_TRUE(result.best.isZero(0));
  EXPECT_THAT(result.reason, HasSubstr("no point that satisfies the limits costs less"));
}

TEST(MissionSearch, RejectsAnImprovementOnItsOwnDrawsOnly) {
  // Points differ by noise only: the factor is so close to 1 that it has no effect.
  DesignSpace still = space(0);
  still.reach = 1e-9;
  const MissionTrial trial(tracking(), *still.point(still.start).controller, 2);
  MissionSearchOptions options;
  options.evaluations = 20;
  const MissionSearchResult result = search_missions(still, trial, options);
  EXPECT_TRUE(!result.accepted || std::abs(result.difference.value) < 1e-6);
}

TEST(MissionSearch, StopsWithTheBestFound) {
  const DesignSpace sluggish = space(-1.2);
  const MissionTrial trial(tracking(), *sluggish.point(sluggish.start).controller, 2);
  MissionSearchOptions options;
  int tried = 0;
  options.progress = [&](double, int evaluations, double left) {
    tried = evaluations;
    EXPECT_LE(left, options.seconds);
  };
  options.stop = [&] { return tried >= 40; };
  options.proof_draws = 6;
  const MissionSearchResult result = search_missions(sluggish, trial, options);
  EXPECT_EQ(result.end, SearchEnd::interrupted);
  EXPECT_LT(result.after.cost, result.before.cost);
}

TEST(MissionSearch, RejectsAPointWithoutProof) {
  const DesignSpace sluggish = space(-1.2);
  const MissionTrial trial(tracking(), *sluggish.point(sluggish.start).controller, 2);
  MissionSearchOptions options;
  options.seconds = 600;
  options.evaluations = 40;
  int tried = 0;
  const int all = search_missions(sluggish, trial, options).evaluations;
  options.progress = [&](double, int evaluations, double) { tried = evaluations; };
  options.stop = [&] { return tried == all; };  // during the proof
  const MissionSearchResult result = search_missions(sluggish, trial, options);
  EXPECT_EQ(result.end, SearchEnd::interrupted);
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.best, sluggish.start);
  EXPECT_NE(result.candidate, sluggish.start);
  EXPECT_THAT(result.reason, HasSubstr("interrupted before the proof of the best point"));
}

TEST(MissionSearch, RejectsAStartWithoutAController) {
  DesignSpace none = space(0);
  none.point = [](const Eigen::VectorXd&) { return DesignPoint{}; };
  const MissionTrial trial(tracking(), testing::designed_mambo_cascade(), 1);
  EXPECT_THAT([&] { (void)search_missions(none, trial, {}); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no solution or is not stable")));
}

}  // namespace
}  // namespace quadtune
