// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/allan.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>

#include "log_files/sensor_noise.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using testing::flicker_record;
using ::testing::HasSubstr;
using testing::quantization_record;
using ::testing::ThrowsMessage;
using testing::walk_record;
using testing::white_record;

/// Equal up to one unit of the last published digit. In exact rational arithmetic the two Hadamard
/// deviations that differ most are 70.806071 and 0.03910860560.
void expect_digits(double value, double published, int digits, const std::string& what) {
  const double unit = std::pow(10, std::floor(std::log10(published)) - digits + 1);
  EXPECT_NEAR(value, published, 1.0001 * unit) << what;
}

struct Published {
  AllanKind kind;
  std::vector<double> deviations;
};

// The ten phases of NBS Monograph 140, annex 8.E, with the answers of NIST SP 1065, pages 107-108.
TEST(AllanDeviation, MeetsThePublishedTenPoints) {
  Eigen::VectorXd phase(10);
  phase << 0.00000, 103.11111, 123.22222, 157.33333, 166.44444, 48.55555, -96.33333, -2.22222,
      111.88889, 0.00000;
  const std::vector<Published> table = {
      {AllanKind::plain, {91.22945, 115.8082}},    {AllanKind::overlapping, {91.22945, 85.95287}},
      {AllanKind::modified, {91.22945, 74.78849}}, {AllanKind::total, {91.22945, 93.90379}},
      {AllanKind::hadamard, {70.80608, 116.7980}}, {AllanKind::time, {52.67135, 86.35831}}};
  for (const Published& row : table) {
    const std::vector<AllanPoint> points = allan_deviation_of_phase(phase, 1, {1, 2}, row.kind);
    for (std::size_t i = 0; i < 2; ++i)
      expect_digits(points[i].deviation, row.deviations[i], 7,
                    std::to_string(static_cast<int>(row.kind)) + " tau " + std::to_string(i + 1));
  }
}

// The thousand points of NIST SP 1065, pages 107-108: a stated generator, answers to 7 digits.
TEST(AllanDeviation, MeetsThePublishedThousandPoints) {
  Eigen::VectorXd rate(1000);
  std::uint64_t n = 1234567890;
  for (double& value : rate) {
    value = static_cast<double>(n) / 2147483647;
    n = 16807 * n % 2147483647;
  }
  expect_digits(std::sqrt((rate.array() - rate.mean()).square().sum() / 999), 2.884664e-1, 7,
                "the series itself");
  const std::vector<Published> table = {
      {AllanKind::plain, {2.922319e-01, 9.965736e-02, 3.897804e-02}},
      {AllanKind::overlapping, {2.922319e-01, 9.159953e-02, 3.241343e-02}},
      {AllanKind::modified, {2.922319e-01, 6.172376e-02, 2.170921e-02}},
      {AllanKind::hadamard, {2.943883e-01, 1.052754e-01, 3.910860e-02}},
      {AllanKind::overlapping_hadamard, {2.943883e-01, 9.581083e-02, 3.237638e-02}},
      {AllanKind::time, {1.687202e-01, 3.563623e-01, 1.253382e+00}}};
  for (const Published& row : table) {
    const std::vector<AllanPoint> points = allan_deviation(rate, 1, {1, 10, 100}, row.kind);
    for (std::size_t i = 0; i < 3; ++i)
      expect_digits(points[i].deviation, row.deviations[i], 7,
                    std::to_string(static_cast<int>(row.kind)) + " decade " + std::to_string(i));
  }
}

// No kind depends on a constant rate, and the three-sample ones do not depend on a ramp either.
TEST(AllanDeviation, IsBlindToAConstantRate) {
  std::mt19937_64 random(3);
  const Eigen::VectorXd rate = white_record(20000, 0.01, 1e-3, random);
  const std::vector<std::size_t> factors = {1, 16, 1024};
  for (const AllanKind kind : {AllanKind::plain, AllanKind::overlapping, AllanKind::modified,
                               AllanKind::total, AllanKind::overlapping_hadamard}) {
    const auto without = allan_deviation(rate, 0.01, factors, kind);
    const auto with = allan_deviation(rate.array() + 4096.0, 0.01, factors, kind);
    for (std::size_t i = 0; i < factors.size(); ++i)  // the sum itself rounds at 5e-13 a sample
      EXPECT_NEAR(with[i].deviation / without[i].deviation, 1, 1e-9);
  }
  const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(20000, 0, 5);
  const auto blind = allan_deviation(rate, 0.01, factors, AllanKind::overlapping_hadamard);
  const auto ramped = allan_deviation(rate + ramp, 0.01, factors, AllanKind::overlapping_hadamard);
  for (std::size_t i = 0; i < factors.size(); ++i)
    EXPECT_NEAR(ramped[i].deviation / blind[i].deviation, 1, 1e-9);
}

// A ramp of slope R has the deviation R tau / √2, exactly.
TEST(AllanDeviation, OfARampIsItsClosedForm) {
  const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(1001, 0, 10);  // 0.01 a sample of 0.5 s
  for (const AllanPoint& point : allan_deviation(ramp, 0.5, {1, 7, 50}))
    EXPECT_NEAR(point.deviation, 0.02 * point.tau / std::sqrt(2), 1e-12);
}

TEST(AllanFactors, LeaveOneTermAtLeast) {
  EXPECT_THAT(allan_factors(10, AllanTaus::octaves), ::testing::ElementsAre(1, 2, 4));
  EXPECT_THAT(allan_factors(50, AllanTaus::decades), ::testing::ElementsAre(1, 2, 4, 10, 20));
  EXPECT_THAT(allan_factors(9, AllanTaus::all, AllanKind::hadamard),
              ::testing::ElementsAre(1, 2, 3));
  for (const AllanKind kind : {AllanKind::plain, AllanKind::modified, AllanKind::hadamard,
                               AllanKind::total, AllanKind::overlapping_hadamard})
    for (const std::size_t n : {3, 10, 31}) {
      const Eigen::VectorXd rate =
          Eigen::VectorXd::LinSpaced(static_cast<Eigen::Index>(n), 0, 1).array().square();
      for (const AllanPoint& point :
           allan_deviation(rate, 1, allan_factors(n, AllanTaus::all, kind), kind))
        EXPECT_GE(point.terms, 1U);
    }
}

TEST(AllanDeviation, RejectsInvalidInput) {
  Eigen::VectorXd rate = Eigen::VectorXd::Ones(100);
  EXPECT_THAT([&] { (void)allan_deviation(rate, 0, {1}); },
              ThrowsMessage<InvalidInput>(HasSubstr("sample period is 0 s, expected a positive")));
  EXPECT_THAT(
      [&] { (void)allan_deviation(rate, 1, {51}); },
      ThrowsMessage<InvalidInput>(HasSubstr("means over 51 samples were requested of 100")));
  EXPECT_THAT([&] { (void)analyse_allan(rate, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected noise")));
  EXPECT_THAT(
      [&] { (void)analyse_allan(rate.head(20), 1); },
      ThrowsMessage<InvalidInput>(HasSubstr("the log has 20 samples, expected at least 64")));
  rate(41) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { (void)allan_deviation(rate, 1, {1}); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("sample 42 of the rate is nan, expected a finite number, because means "
                            "over a gap")));
}

/// Range of successes in `trials` with probability 0.95 each that is left only once in ten thousand
/// times at each end.
void expect_coverage(int inside, int trials) {
  const double mean = 0.95 * trials, spread = std::sqrt(trials * 0.95 * 0.05);
  EXPECT_GE(inside, mean - 4 * spread) << inside << " of " << trials;
  EXPECT_LE(inside, trials);
}

// The equivalent degrees of freedom agree with those of seeded records: 2 E² / var.
TEST(AllanAnalysis, EstimatesTheVarianceOfItsPoints) {
  constexpr int kRecords = 600;
  constexpr Eigen::Index kSamples = 512;
  struct Case {
    const char* name;
    std::function<Eigen::VectorXd(std::mt19937_64&)> make;
  };
  const std::vector<Case> cases = {
      {"white", [](auto& random) { return white_record(kSamples, 1, 1, random); }},
      {"walk", [](auto& random) { return walk_record(kSamples, 1, 1, random); }},
      {"quantization", [](auto& random) { return quantization_record(kSamples, 1, 1, random); }},
      {"flicker", [](auto& random) { return flicker_record(kSamples, 1, random); }}};
  for (const Case& c : cases) {
    std::mt19937_64 random(11);
    std::map<std::size_t, std::pair<double, double>> sums;
    std::map<std::size_t, std::vector<double>> edf;
    for (int i = 0; i < kRecords; ++i) {
      const AllanAnalysis analysis = analyse_allan(c.make(random), 1);
      for (const AllanCurvePoint& at : analysis.curve) {
        const double variance = at.point.deviation * at.point.deviation;
        sums[at.point.m].first += variance;
        sums[at.point.m].second += variance * variance;
        edf[at.point.m].push_back(at.edf);
      }
    }
    for (auto& [m, sum] : sums) {
      if (m > 64) continue;
      const double mean = sum.first / kRecords;
      const double seen = 2 * mean * mean / (sum.second / kRecords - mean * mean);
      std::vector<double>& told = edf[m];
      std::nth_element(told.begin(), told.begin() + kRecords / 2, told.end());
      // The variance estimated from 600 records has an error of √(2/600) = 6 %, and more for a
      // heavy-tailed distribution.
      EXPECT_NEAR(told[kRecords / 2] / seen, 1, 0.3) << c.name << " m " << m << " seen " << seen;
    }
  }
}

TEST(AllanAnalysis, FindsNoiseDensityWithinItsInterval) {
  std::mt19937_64 random(5);
  int inside = 0;
  for (int i = 0; i < 200; ++i) {
    const double N = std::exp(std::uniform_real_distribution(-9.0, 2.0)(random));
    const AllanAnalysis a = analyse_allan(white_record(4096, 0.01, N, random), 0.01);
    ASSERT_TRUE(a.noise_density.seen);
    EXPECT_NEAR(a.noise_density.value / N, 1, 0.1);
    EXPECT_EQ(a.noise_density.tau_from, 0.01);
    if (a.noise_density.low <= N && N <= a.noise_density.high) ++inside;
  }
  expect_coverage(inside, 200);
}

TEST(AllanAnalysis, FindsEachNoiseOfASumWithinItsInterval) {
  std::mt19937_64 random(7);
  int inside_N = 0, inside_K = 0, seen_K = 0;
  constexpr double N = 0.01, K = 0.002;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd rate =
        white_record(60000, 0.01, N, random) + walk_record(60000, 0.01, K, random);
    const AllanAnalysis a = analyse_allan(rate, 0.01);
    ASSERT_TRUE(a.noise_density.seen);
    if (a.noise_density.low <= N && N <= a.noise_density.high) ++inside_N;
    if (!a.random_walk.seen) continue;
    ++seen_K;
    if (a.random_walk.low <= K && K <= a.random_walk.high) ++inside_K;
  }
  expect_coverage(inside_N, 100);
  EXPECT_GE(seen_K, 95);
  expect_coverage(inside_K, seen_K);
}

TEST(AllanAnalysis, ReportsNoisesThatAreNotInTheRecord) {
  std::mt19937_64 random(9);
  int bounded = 0;
  for (int i = 0; i < 40; ++i) {
    const AllanAnalysis a = analyse_allan(white_record(4096, 0.01, 0.3, random), 0.01);
    if (a.random_walk.seen) continue;
    EXPECT_THAT(a.random_walk.reason, HasSubstr("too short: no slope of +1/2 up to 5.12 s"));
    EXPECT_GT(a.random_walk.at_most, 0);
    EXPECT_EQ(a.random_walk.value, 0);
    EXPECT_FALSE(a.bias_instability.seen);
    EXPECT_THAT(a.bias_instability.reason, HasSubstr("too short: the curve still falls"));
    EXPECT_GT(a.bias_instability.at_most, 0);
    ++bounded;
  }
  EXPECT_GE(bounded, 36);
}

// 0.664 B, flat; the floor is the minimum of the curve.
TEST(AllanAnalysis, ReadsTheFloorOfFlicker) {
  std::mt19937_64 random(13);
  int inside = 0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd rate =
        white_record(16384, 0.1, 0.5, random) + flicker_record(16384, 0.5, random);
    const AllanAnalysis a = analyse_allan(rate, 0.1);
    ASSERT_TRUE(a.bias_instability.seen) << a.bias_instability.reason;
    EXPECT_NEAR(a.bias_instability.value, 0.5, 0.15);
    const double B = std::sqrt(a.variances[static_cast<std::size_t>(AllanNoise::flicker)]);
    EXPECT_NEAR(B, 0.5, 0.1);
    if (a.bias_instability.low <= 0.5 && 0.5 <= a.bias_instability.high) ++inside;
  }
  EXPECT_GE(inside, 14);  // the minimum of a curve is biased low
}

TEST(AllanAnalysis, SeesQuantization) {
  std::mt19937_64 random(17);
  int inside = 0;
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd rate =
        white_record(8192, 0.01, 1e-3, random) + quantization_record(8192, 0.01, 2e-4, random);
    const AllanAnalysis a = analyse_allan(rate, 0.01);
    ASSERT_TRUE(a.quantization.seen);
    if (a.quantization.low <= 2e-4 && 2e-4 <= a.quantization.high) ++inside;
  }
  expect_coverage(inside, 50);
}

// A low-pass filter removes fast noise; the density is estimated where the slope is right.
TEST(AllanAnalysis, ExcludesOctavesThatAFilterShapes) {
  std::mt19937_64 random(19);
  Eigen::VectorXd rate = white_record(100000, 0.01, 0.02, random);
  for (Eigen::Index i = 1; i < rate.size(); ++i) rate(i) = 0.8 * rate(i - 1) + 0.2 * rate(i);
  const AllanAnalysis a = analyse_allan(rate, 0.01);
  EXPECT_TRUE(a.explained);
  EXPECT_GT(a.fitted_from, 0.05);
  ASSERT_TRUE(a.noise_density.seen);
  EXPECT_NEAR(a.noise_density.value, 0.02, 0.0015);
}

// A tone is not one of the noises: the curve has a hump, and the result says so.
TEST(AllanAnalysis, RejectsATone) {
  std::mt19937_64 random(23);
  Eigen::VectorXd rate = white_record(65536, 0.01, 0.001, random);
  for (Eigen::Index i = 0; i < rate.size(); ++i)
    rate(i) += 0.05 * std::sin(2 * std::numbers::pi * 0.2 * 0.01 * static_cast<double>(i));
  const AllanAnalysis a = analyse_allan(rate, 0.01);
  EXPECT_FALSE(a.explained);
  EXPECT_FALSE(a.noise_density.seen || a.random_walk.seen || a.quantization.seen);
  EXPECT_THAT(a.random_walk.reason, HasSubstr("the curve is not a sum of noises"));
}

// A record of a random walk only has no floor.
TEST(AllanAnalysis, ReportsThatARandomWalkHasNoFloor) {
  std::mt19937_64 random(29);
  const AllanAnalysis a = analyse_allan(walk_record(4096, 0.1, 0.3, random), 0.1);
  EXPECT_TRUE(a.random_walk.seen);
  EXPECT_FALSE(a.bias_instability.seen);
  EXPECT_THAT(a.bias_instability.reason, HasSubstr("rises from the first tau on"));
}

// The barometer with motors off is white up to 1.6 s with half a metre; a gyroscope in flight is
// not.
TEST(AllanAnalysis, DistinguishesStationaryAndMovingLogs) {
  QUADTUNE_REQUIRE_DATA(data);
  std::ifstream still(data / "uquad2" / "log_test_IMU_3.txt");
  std::vector<double> height;
  for (std::string line; std::getline(still, line);) {
    std::istringstream words(line);
    double value = 0;
    for (int i = 0; i < 19; ++i) words >> value;
    height.push_back(value);
  }
  ASSERT_EQ(height.size(), 4529U);
  const AllanAnalysis baro =
      analyse_allan(Eigen::VectorXd::Map(height.data(), std::ssize(height)), 0.05);
  EXPECT_TRUE(baro.explained);
  ASSERT_TRUE(baro.noise_density.seen);
  EXPECT_NEAR(baro.noise_density.value / std::sqrt(0.05), 0.51, 0.03);  // m a sample

  std::ifstream moving(data / "euroc" / "V1_01_easy_imu0.csv");
  std::vector<double> rate;
  std::string line;
  std::getline(moving, line);
  while (std::getline(moving, line)) rate.push_back(std::stod(line.substr(line.find(',') + 1)));
  const AllanAnalysis gyro =
      analyse_allan(Eigen::VectorXd::Map(rate.data(), std::ssize(rate)), 0.005);
  EXPECT_FALSE(gyro.explained);
  EXPECT_FALSE(gyro.noise_density.seen || gyro.random_walk.seen || gyro.bias_instability.seen);
}

}  // namespace
}  // namespace quadtune
