// SPDX-License-Identifier: Apache-2.0
#include "quadtune/logs/log_survey.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "log_files/read_logs.hpp"
#include "log_files/ulog_writer.hpp"
#include "logs/interval_statistics.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using ::testing::DoubleNear;

LogSurvey survey_of(const std::string& bytes, const LogOptions& options = {}) {
  return survey_log(*internal::open_log(internal::ByteStream(bytes, "f.log"), options));
}

const LogChannelSurvey& channel(const LogSurvey& survey, const std::string& name) {
  for (const LogChannelSurvey& one : survey.channels)
    if (one.channel.name == name) return one;
  throw std::runtime_error("no channel " + name);
}

LogTiming timing_of(const std::vector<double>& times) {
  internal::IntervalStatistics statistics;
  for (const double t : times) statistics.take(t);
  return statistics.timing();
}

TEST(LogSurvey, StatisticsAreThoseOfTheTwoPassFormulas) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(1e6, 1);  // far from 0: sums of squares would cancel
  std::string text = "t,x\n";
  std::vector<double> values;
  for (int i = 0; i < 5000; ++i) {
    values.push_back(normal(random));
    text += fmt::format("{},{}\n", 0.01 * i, values.back());
  }
  const LogSurvey survey = survey_of(text);
  double mean = 0;
  double sum = 0;
  for (const double x : values) mean += x / 5000;
  for (const double x : values) sum += (x - mean) * (x - mean);
  const LogChannelSurvey& x = channel(survey, "x");
  EXPECT_EQ(x.samples, 5000U);
  EXPECT_NEAR(x.mean, mean, 1e-8);
  EXPECT_NEAR(x.std, std::sqrt(sum / 4999), 1e-9);
  EXPECT_EQ(x.min, *std::min_element(values.begin(), values.end()));
  EXPECT_EQ(x.max, *std::max_element(values.begin(), values.end()));
  EXPECT_NEAR(x.timing.rate_hz, 100, 1e-9);
  EXPECT_NEAR(survey.duration_s, 49.99, 1e-9);
}

TEST(LogSurvey, FindsGapsJumpsAndTimesTwice) {
  const LogTiming steady = timing_of({0, 0.1, 0.2, 0.3, 0.4});
  EXPECT_NEAR(steady.period_s, 0.1, 1e-12);
  EXPECT_EQ(steady.gaps, 0U);
  const LogTiming gap = timing_of({0, 0.1, 0.2, 0.5, 0.6, 0.84, 0.94});  // 0.24 is no gap
  EXPECT_EQ(gap.gaps, 1U);
  EXPECT_NEAR(gap.longest_gap_s, 0.3, 1e-12);
  EXPECT_NEAR(gap.rate_hz, 5 / 0.64, 1e-9);  // of what is no gap
  const LogTiming odd = timing_of({0, 0.1, 0.1, 0.2, 0.05, 0.15, 0.25, 100, 100.1});
  EXPECT_EQ(odd.duplicates, 1U);
  EXPECT_EQ(odd.backwards, 1U);
  EXPECT_EQ(odd.forwards, 1U);
  EXPECT_EQ(odd.gaps, 1U);
  EXPECT_NEAR(odd.duration_s, 100.1, 1e-12);
  const LogTiming one = timing_of({3});
  EXPECT_EQ(one.first_s, 3);
  EXPECT_TRUE(std::isnan(one.rate_hz));
  EXPECT_TRUE(std::isnan(timing_of({}).first_s));
}

// The median over many octaves, within the 1.6 % of a bin.
TEST(LogSurvey, ThePeriodIsTheMedianInterval) {
  std::mt19937_64 random(2);
  std::lognormal_distribution<double> interval(0, 1);
  std::vector<double> times = {0};
  std::vector<double> intervals;
  for (int i = 0; i < 20001; ++i) {
    intervals.push_back(interval(random));
    times.push_back(times.back() + intervals.back());
  }
  std::nth_element(intervals.begin(), intervals.begin() + 10000, intervals.end());
  EXPECT_NEAR(timing_of(times).period_s / intervals[10000], 1, 0.016);
}

// A slow sensor in a table of a fast one has its own rate and gaps.
TEST(LogSurvey, AChannelIsTimedByTheRowsInWhichItHasAValue) {
  std::string text = "t,fast,slow,never\n";
  for (int i = 0; i < 100; ++i) {
    const bool slow = i % 5 == 2 && i != 52 && i != 57;
    text += fmt::format("{},{},{},\n", 0.01 * i, i, slow ? "1" : "");
  }
  const LogSurvey survey = survey_of(text);
  EXPECT_NEAR(channel(survey, "fast").timing.rate_hz, 100, 1e-9);
  const LogChannelSurvey& slow = channel(survey, "slow");
  EXPECT_NEAR(slow.timing.rate_hz, 20, 1e-9);
  EXPECT_EQ(slow.timing.gaps, 1U);
  EXPECT_NEAR(slow.timing.longest_gap_s, 0.15, 1e-12);
  EXPECT_EQ(slow.samples, 18U);
  EXPECT_EQ(slow.nan, 82U);
  EXPECT_TRUE(slow.constant);
  EXPECT_NEAR(slow.timing.first_s, 0.02, 1e-12);
  EXPECT_EQ(channel(survey, "never").samples, 0U);
  EXPECT_TRUE(std::isnan(channel(survey, "never").min));
  EXPECT_FALSE(channel(survey, "never").constant);
  EXPECT_EQ(survey.groups[0].timing.gaps, 0U);
}

TEST(LogSurvey, TellsASensorAtItsLimitFromOneAtRest) {
  std::string text = "t,clipped,rests,steps,free\n";
  for (int i = 0; i < 400; ++i) {
    const double wave = std::sin(0.05 * i);
    text += fmt::format("{},{},{},{},{}\n", 0.01 * i, std::min(wave, 0.8),
                        i < 100 ? 0 : std::abs(wave) + 0.001 * i, i / 100, wave);
  }
  const LogSurvey survey = survey_of(text);
  EXPECT_EQ(channel(survey, "clipped").saturated, 26U);  // where sin > 0.8
  for (const char* name : {"rests", "steps", "free"})
    EXPECT_EQ(channel(survey, name).saturated, 0U) << name;
}

TEST(LogSurvey, KeepsGroupsApart) {
  const LogSurvey survey = survey_of(testing::sample_ulog().bytes());
  ASSERT_EQ(survey.groups.size(), 3U);
  EXPECT_NEAR(survey.groups[0].timing.rate_hz, 100, 1e-9);
  EXPECT_NEAR(survey.groups[2].timing.rate_hz, 50, 1e-9);
  EXPECT_EQ(survey.groups[2].rows, 5U);
  EXPECT_NEAR(survey.duration_s, 0.091, 1e-12);
  EXPECT_EQ(survey.condition.dropouts, 1U);
}

// Rates as the README of the data and the sensors' files state them.
TEST(LogSurvey, OfRealLogs) {
  QUADTUNE_REQUIRE_DATA(data);
  const auto survey = [&](const char* file, const LogOptions& options = {}) {
    return survey_log(*open_log((data / file).string(), options));
  };
  const LogSurvey imu = survey("euroc/V1_01_easy_imu0.csv");
  EXPECT_EQ(imu.groups[0].rows, 29120U);
  EXPECT_NEAR(imu.duration_s, 145.595, 1e-6);
  EXPECT_THAT(imu.groups[0].timing.rate_hz, DoubleNear(200, 1e-3));
  EXPECT_EQ(imu.channels[3].channel.unit, "m/s^2");
  const LogSurvey truth = survey("euroc/V1_01_easy_gt_20Hz.csv");
  EXPECT_EQ(truth.epoch_s, imu.epoch_s);
  const LogSurvey text = survey("mambo/flight_A.csv");
  const LogSurvey mat = survey("mambo/flight_A.mat");
  EXPECT_NEAR(text.duration_s, 6.205, 1e-9);
  EXPECT_NEAR(mat.duration_s, 6.205, 1e-9);
  EXPECT_NEAR(channel(mat, "motors[2]").mean, channel(text, "m2").mean, 1e-6);
  EXPECT_EQ(channel(text, "m2").nan, 242U);
  const LogSurvey replay = survey("px4/replay_data__iris_gps.csv");
  EXPECT_EQ(replay.groups.size(), 6U);
  EXPECT_EQ(channel(replay, "accel_x").samples, 7062U);
  const LogSurvey still =
      survey("uquad2/log_test_IMU_3.txt", testing::with_columns("t_s:17, t_us:18, height[m]:19"));
  EXPECT_NEAR(still.groups[0].timing.rate_hz, 19.96, 0.01);
  EXPECT_NEAR(channel(still, "height").std, 0.554, 0.001);
  EXPECT_EQ(survey("uquad/imu_raw_static_20.txt").groups[0].rows, 20U);
  EXPECT_EQ(survey("known/nile.csv").groups[0].rows, 100U);
}

}  // namespace
}  // namespace quadtune
