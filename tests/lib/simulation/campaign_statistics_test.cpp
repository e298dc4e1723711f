// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/campaign_statistics.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "numbers.hpp"
#include "plants/designed_mambo.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

using testing::kInfinity;

// R: binom.test(k, n)$conf.int; at the ends (α/2)^(1/n).
TEST(SuccessRate, HasTheIntervalOfClopperAndPearson) {
  const Estimated some = success_rate(8, 10);
  EXPECT_DOUBLE_EQ(some.value, 0.8);
  EXPECT_NEAR(some.low, 0.4439045, 1e-7);
  EXPECT_NEAR(some.high, 0.9747893, 1e-7);
  const Estimated all = success_rate(100, 100);
  EXPECT_NEAR(all.low, std::pow(0.025, 0.01), 1e-12);
  EXPECT_EQ(all.high, 1);
  const Estimated none = success_rate(0, 100);
  EXPECT_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 1 - std::pow(0.025, 0.01), 1e-12);
  EXPECT_LE(success_rate(1, 1).low, 0.0250001);
}

// However the probability, at least 95 % of the intervals hold it.
TEST(SuccessRate, HoldsTheTruth) {
  for (const double p : {0.01, 0.3, 0.97}) {
    double missed = 0;
    const int n = 60;
    double weight = std::pow(1 - p, n);  // of k successes
    for (int k = 0; k <= n; ++k) {
      const Estimated rate = success_rate(static_cast<std::uint64_t>(k), n);
      if (rate.low > p || rate.high < p) missed += weight;
      weight *= p / (1 - p) * (n - k) / (k + 1);
    }
    EXPECT_LE(missed, 0.05) << p;
  }
}

TEST(Quantile, LiesBetweenNeighboursAsRsType7) {
  const std::vector<double> x = {1, 2, 4, 8, 16};
  EXPECT_DOUBLE_EQ(quantile(x, 0.5).value, 4);
  EXPECT_DOUBLE_EQ(quantile(x, 0.25).value, 2);
  EXPECT_DOUBLE_EQ(quantile(x, 0.9).value, 8 + 0.6 * 8);
  EXPECT_EQ(quantile(x, 0.5).low, -kInfinity);  // five are too few for an interval
  const std::vector<double> one = {3};
  EXPECT_DOUBLE_EQ(quantile(one, 0.05).value, 3);
}

// The widest pair of order statistics that 2.5 % lie beyond: 40th and 61st of 100 for the median
// [Conover 1999].
TEST(Quantile, HasTheIntervalOfTheBinomialDistribution) {
  std::vector<double> x(100);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i + 1);
  const Estimated median = quantile(x, 0.5);
  EXPECT_EQ(median.low, 40);
  EXPECT_EQ(median.high, 61);
  EXPECT_EQ(quantile(x, 0.99).high, kInfinity);
}

TEST(Quantile, TheIntervalHoldsTheTruth) {
  std::mt19937_64 random(5);
  std::exponential_distribution<double> exponential;
  for (const double q : {0.05, 0.5, 0.95}) {
    int held = 0;
    constexpr int kRuns = 2000;
    for (int run = 0; run < kRuns; ++run) {
      std::vector<double> x(200);
      for (double& value : x) value = exponential(random);
      std::sort(x.begin(), x.end());
      const Estimated estimated = quantile(x, q);
      const double truth = -std::log(1 - q);
      held += static_cast<int>(estimated.low <= truth && truth <= estimated.high);
    }
    // At least 95 %, less three standard errors of 2,000 runs; and not much more than needed.
    EXPECT_GE(held, 0.935 * kRuns) << q;
    EXPECT_LE(held, 0.985 * kRuns) << q;
  }
}

TEST(Quantile, InfiniteValuesAreTheGreatest) {
  std::vector<double> x(1000, kInfinity);
  for (std::size_t i = 0; i < 980; ++i) x[i] = static_cast<double>(i);
  EXPECT_NEAR(quantile(x, 0.5).value, 499.5, 1e-9);
  EXPECT_EQ(quantile(x, 0.99).value, kInfinity);
  EXPECT_FALSE(std::isnan(quantile(x, 0.9795).value));
}

TEST(Quantile, OfValuesInAnyOrderIsTheSame) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (const std::size_t n : {1U, 2U, 7U, 24U, 101U}) {
    std::vector<double> x(n);
    for (double& value : x) value = normal(random);
    if (n > 2) x[0] = x[1] = kInfinity;
    std::vector<double> sorted = x;
    std::sort(sorted.begin(), sorted.end());
    for (const double q : {0.01, 0.3, 0.5, 0.72, 0.8, 0.9, 0.99}) {
      std::shuffle(x.begin(), x.end(), random);
      EXPECT_EQ(sample_quantile(x, q), quantile(sorted, q).value) << n << " " << q;
    }
  }
}

// R: cor(x, y, method = "spearman")
TEST(RankCorrelation, IsSpearmans) {
  const std::vector<double> x = {1, 2, 3, 4, 5, 6}, y = {1, 4, 9, 16, 25, 36};
  EXPECT_DOUBLE_EQ(rank_correlation(x, y).value, 1);
  const std::vector<double> z = {2, 1, 4, 3, 6, 5};
  EXPECT_NEAR(rank_correlation(x, z).value, 0.8285714, 1e-7);
  const std::vector<double> tied = {1, 1, 2, 2, 3, 3};
  EXPECT_NEAR(rank_correlation(x, tied).value, 0.9561829, 1e-7);
  const std::vector<double> constant(6, 1.0);
  EXPECT_TRUE(std::isnan(rank_correlation(x, constant).value));
  std::vector<double> reached = {1, 2, 3, 4, kInfinity, kInfinity};
  EXPECT_GT(rank_correlation(x, reached).value, 0.95);
}

// Four pairs in the same order happen by chance in one of 24 cases.
TEST(RankCorrelation, OfFewPairsIsUncertainAlsoIfItIsOne) {
  const std::vector<double> x = {1, 2, 3, 4}, reversed = {4, 3, 2, 1};
  const Estimated one = rank_correlation(x, x), opposite = rank_correlation(x, reversed);
  EXPECT_DOUBLE_EQ(one.value, 1);
  EXPECT_LT(one.low, 0);
  EXPECT_GT(one.high, 0.9);
  EXPECT_LE(one.high, 1);
  EXPECT_DOUBLE_EQ(opposite.value, -1);
  EXPECT_DOUBLE_EQ(opposite.low, -one.high);
  EXPECT_DOUBLE_EQ(opposite.high, -one.low);
  std::vector<double> many(200);
  std::iota(many.begin(), many.end(), 0);
  EXPECT_GT(rank_correlation(many, many).low, 0.9999);
}

/// Synthetic records: the first design fails where the mass is large.
TEST(CampaignStatistics, FindsWhatFlightsDependOn) {
  Campaign campaign;
  CampaignCase of;
  of.design = "one";
  of.mission = "hover";
  of.setup.mission = load_mission("hover");
  campaign.cases = {of, of};
  campaign.cases[1].design = "two";
  campaign.uncertainty.numbers = {{"mass", {DistributionKind::normal, 1, 0.05}},
                                  {"wind_north", {DistributionKind::normal, 0, 1}}};
  campaign.flights = 400;
  std::vector<CampaignRecord> records;
  std::uint64_t failed = 0;
  for (std::uint32_t flight = 0; flight < campaign.flights; ++flight) {
    const Eigen::VectorXd drawn = draw(campaign.uncertainty, campaign.seed, flight);
    for (std::uint64_t c = 0; c < 2; ++c) {
      CampaignRecord record;
      record.number = std::uint64_t{flight} * 2 + c;
      record.passed = c == 1 || drawn(0) < 1.05;
      record.end = record.passed ? FlightEnd::completed : FlightEnd::safety_exit;
      record.end_time = record.passed ? 100 : 2 / drawn(0);
      if (!record.passed) record.reason = "tilt";
      failed += static_cast<std::uint64_t>(!record.passed);
      record.metrics[Metric::tracking_rms] =
          0.1 + 0.02 * static_cast<double>(c) + 0.01 * std::abs(drawn(1));
      records.push_back(record);
    }
  }
  const Eigen::MatrixXd all = all_draws(campaign);
  const CampaignStatistics statistics = campaign_statistics(campaign, all, records);
  ASSERT_EQ(statistics.cases.size(), 2);
  const CaseStatistics& one = statistics.cases[0];
  EXPECT_EQ(one.flights, 400);
  EXPECT_EQ(one.passed, 400 - failed);
  EXPECT_THAT(one.ends,
              ElementsAre(Pair("completed", 400 - failed), Pair("safety exit: tilt", failed)));
  ASSERT_FALSE(one.sensitivities.empty());
  EXPECT_EQ(one.sensitivities[0].quantity, "mass");
  EXPECT_EQ(one.sensitivities[0].figure, "failure");
  EXPECT_GT(one.sensitivities[0].correlation.low, 0.4);
  // |wind| is no trend of the wind.
  for (const Sensitivity& s : one.sensitivities)
    if (s.quantity == "wind_north" && s.figure == "tracking_rms") {
      EXPECT_LT(std::abs(s.correlation.value), 0.2);
    }
  // The earliest end is the worst.
  ASSERT_EQ(one.worst.size(), 5);
  const auto end_time = [&](std::size_t i) { return records[one.worst[i].number].end_time; };
  EXPECT_LE(end_time(0), end_time(1));
  double earliest = kInfinity;
  for (const CampaignRecord& record : records) earliest = std::min(earliest, record.end_time);
  EXPECT_EQ(end_time(0), earliest);
  EXPECT_EQ(statistics.cases[1].passed, 400);

  // On the same draws the difference of the designs is known exactly, whatever the wind.
  ASSERT_EQ(statistics.comparisons.size(), 1);
  const CaseComparison& comparison = statistics.comparisons[0];
  EXPECT_EQ(comparison.only_second_passed, failed);
  EXPECT_EQ(comparison.only_first_passed, 0);
  for (const CaseComparison::Difference& d : comparison.metrics)
    if (d.metric == Metric::tracking_rms) {
      EXPECT_NEAR(d.mean.value, 0.02, 1e-12);
      EXPECT_NEAR(d.mean.high - d.mean.low, 0, 1e-12);
    }
}

// A violation that is not a number is described in words.
TEST(CampaignStatistics, TellsTheWorstOfFiguresThatWereNotReached) {
  Campaign campaign;
  CampaignCase of;
  of.design = "one";
  of.mission = "hover";
  of.setup.mission = load_mission("hover");
  of.setup.mission.limits = {{Metric::settling_time, 10}, {Metric::tracking_max, 0.3}};
  campaign.cases = {of};
  campaign.flights = 3;
  std::vector<CampaignRecord> records(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    records[i].number = i;
    records[i].metrics[Metric::tracking_max] = 0.2;
  }
  records[1].metrics[Metric::settling_time] = kInfinity;
  records[2].metrics[Metric::settling_time] = 12;
  const CampaignStatistics statistics = campaign_statistics(campaign, all_draws(campaign), records);
  const std::vector<WorstFlight>& worst = statistics.cases[0].worst;
  ASSERT_EQ(worst.size(), 3);
  EXPECT_EQ(worst[0].why, "settling_time not measured, limit 10 s");
  EXPECT_EQ(worst[1].why, "settling_time never reached, limit 10 s");
  EXPECT_EQ(worst[2].why, "settling_time 12 s, limit 10 s");
}

// A figure that some flights lack: its correlations are those of the others alone, whatever the
// threads, and ties among what was drawn count as such.
TEST(CampaignStatistics, AnAbsentFigureLeavesTheFlightOut) {
  Campaign campaign;
  CampaignCase of;
  of.design = "one";
  of.mission = "hover";
  of.setup.mission = load_mission("hover");
  campaign.cases = {of};
  campaign.uncertainty.numbers = {{"mass", {DistributionKind::normal, 1, 0.05}},
                                  {"thrust", {DistributionKind::normal, 1, 0}}};
  campaign.flights = 300;
  Eigen::MatrixXd drawn = all_draws(campaign);
  for (Eigen::Index i = 0; i < drawn.cols(); ++i) drawn(0, i) = std::round(drawn(0, i) * 50) / 50;
  std::vector<CampaignRecord> records(campaign.flights);
  std::vector<double> mass, settled;
  std::mt19937_64 random(3);
  for (std::uint32_t i = 0; i < campaign.flights; ++i) {
    records[i].number = i;
    records[i].passed = true;
    if (random() % 3 == 0) continue;
    mass.push_back(drawn(0, i));
    settled.push_back(random() % 5 == 0 ? kInfinity
                                        : mass.back() + 0.1 * static_cast<double>(random() % 4));
    records[i].metrics[Metric::settling_time] = settled.back();
  }
  const Estimated expected = rank_correlation(mass, settled);
  for (const std::size_t threads : {1, 3}) {
    const CampaignStatistics statistics = campaign_statistics(campaign, drawn, records, threads);
    int found = 0;
    for (const Sensitivity& s : statistics.cases[0].sensitivities) {
      EXPECT_EQ(s.quantity, "mass");  // the thrust does not vary
      if (s.figure != "settling_time") continue;
      ++found;
      EXPECT_EQ(s.correlation.value, expected.value);
      EXPECT_EQ(s.correlation.low, expected.low);
      EXPECT_EQ(s.correlation.high, expected.high);
    }
    EXPECT_EQ(found, 1);
    ASSERT_FALSE(statistics.cases[0].metrics.empty());
    EXPECT_EQ(statistics.cases[0].metrics.back().flights, settled.size());
  }
}

}  // namespace
}  // namespace quadtune
