// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/sensor_drift.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/sensor_channel.hpp"
#include "same_flight.hpp"
#include "vehicle_text.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::first_difference;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using testing::vehicle_text;

constexpr std::uint32_t kFlights = 20000;

// The errors of many flights at some samples: [sample][flight].
std::vector<std::vector<Vector3d>> errors(const SensorFaults& faults,
                                          const std::vector<std::uint64_t>& samples) {
  std::vector<std::vector<Vector3d>> all(samples.size());
  for (std::uint32_t flight = 0; flight < kFlights; flight += 8) {
    std::array<SensorFaults, 8> each;
    each.fill(faults);
    SensorDrift<8, 3> drift(each, 20);
    RandomSource<8> source{9, {}};
    for (std::uint32_t l = 0; l < 8; ++l) source.flight[l] = flight + l;
    std::size_t next = 0;
    for (std::uint64_t k = 0; next < samples.size(); ++k) {
      SensorDrift<8, 3>::Values y = SensorDrift<8, 3>::Values::Zero();
      drift.add_to(y, k, source);
      if (k != samples[next]) continue;
      for (int l = 0; l < 8; ++l)
        all[next].push_back({lane(y(0), l), lane(y(1), l), lane(y(2), l)});
      ++next;
    }
  }
  return all;
}

double covariance(const std::vector<Vector3d>& a, int i, const std::vector<Vector3d>& b, int j) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n](i) * b[n](j);
  return sum / static_cast<double>(a.size());
}

// Five standard deviations of a variance known from so many flights.
double tolerance(double variance) { return 5 * std::sqrt(2.0 / kFlights) * variance; }

TEST(SensorDrift, TurnsOnWithABiasThatStays) {
  SensorFaults faults;
  faults.rate = 100;
  faults.turn_on_bias = {0.1, 0.2, 0};
  const auto at = errors(faults, {0, 1, 500});
  EXPECT_NEAR(covariance(at[0], 0, at[0], 0), 0.01, tolerance(0.01));
  EXPECT_NEAR(covariance(at[0], 1, at[0], 1), 0.04, tolerance(0.04));
  EXPECT_NEAR(covariance(at[0], 0, at[0], 1), 0, tolerance(0.02));
  for (std::size_t n = 0; n < at[0].size(); n += 100) {
    EXPECT_EQ(at[0][n], at[2][n]);
    EXPECT_EQ(at[0][n](2), 0);
  }
}

// Var = σ² t of a walk, whatever the rate.
TEST(SensorDrift, WalksWithTheRootOfTime) {
  for (const double rate : {10.0, 40.0}) {
    SensorFaults faults;
    faults.rate = rate;
    faults.bias_walk = {0.3, 0, 0.5};
    const auto n = [&](double t) { return static_cast<std::uint64_t>(std::lround(t * rate)); };
    const auto at = errors(faults, {0, n(1), n(4)});
    EXPECT_EQ(covariance(at[0], 0, at[0], 0), 0);
    for (const auto& [axis, sigma] : std::vector<std::pair<int, double>>{{0, 0.3}, {2, 0.5}}) {
      EXPECT_NEAR(covariance(at[1], axis, at[1], axis), sigma * sigma, tolerance(sigma * sigma));
      EXPECT_NEAR(covariance(at[2], axis, at[2], axis), 4 * sigma * sigma,
                  tolerance(4 * sigma * sigma));
      // Its steps do not depend on where it is.
      EXPECT_NEAR(covariance(at[1], axis, at[2], axis), sigma * sigma,
                  tolerance(2 * sigma * sigma));
    }
  }
}

// σ² e^(-s/τ) between samples s apart, from the first sample on, whatever the rate.
TEST(SensorDrift, StaysAlikeOverItsTimeConstant) {
  for (const double rate : {1.0, 5.0}) {
    SensorFaults faults;
    faults.rate = rate;
    faults.correlated_noise = {2, 1, 3};
    faults.correlation = 20;
    const auto n = [&](double t) { return static_cast<std::uint64_t>(std::lround(t * rate)); };
    const std::vector<double> times = {0, 5, 20, 60};
    const auto at = errors(faults, {n(0), n(5), n(20), n(60)});
    for (int axis = 0; axis < 3; ++axis) {
      const double variance = std::pow(faults.correlated_noise(axis), 2);
      for (std::size_t i = 0; i < times.size(); ++i) {
        EXPECT_NEAR(covariance(at[i], axis, at[i], axis), variance, tolerance(variance));
        EXPECT_NEAR(covariance(at[0], axis, at[i], axis), variance * std::exp(-times[i] / 20),
                    tolerance(variance))
            << rate << " " << times[i];
      }
      EXPECT_NEAR(covariance(at[1], axis, at[1], (axis + 1) % 3), 0, tolerance(6));
    }
  }
}

// √(noise² + (growth h)²) at the height h.
TEST(SensorDrift, NoiseGrowsInQuadrature) {
  SensorFaults faults;
  faults.rate = 60;
  faults.noise.setConstant(0.03);
  SensorChannel<1, 2> channel({faults}, 20);
  const Pack<1> more = 0.04;
  Sample<Eigen::Matrix<Pack<1>, 2, 1>, Pack<1>> sample;
  double sum = 0;
  const int count = 20000;
  for (int k = 0; k < count; ++k) {
    channel.take(SensorChannel<1, 2>::Values(0.0, 0.0), {4, {}}, {}, nullptr, &more);
    channel.deliver(channel.next(), 1.0 / 60, sample);
    sum += std::pow(lane(sample.value(0), 0), 2) + std::pow(lane(sample.value(1), 0), 2);
  }
  EXPECT_NEAR(sum / (2 * count), 0.0025, 5 * 0.0025 / std::sqrt(static_cast<double>(count)));
}

FlightSetup hover_at(double height) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.estimator = EstimatorKind::truth;
  setup.mission = parse_mission(
      "name = \"h\"\nduration_s = 2\n[start]\nat = \"air\"\nheight_m = " + std::to_string(height) +
          "\n[hover]\nheight_m = " + std::to_string(height) + "\n",
      "h.toml");
  setup.log = true;
  return setup;
}

int flows(const FlightSetup& setup) {
  int count = 0;
  const FlightResult result = fly(setup);
  for (const double value : result.log.find("flow.x")->values)
    if (std::isfinite(value)) ++count;
  return count;
}

TEST(SensorDrift, FlowIsLostAboveItsHeight) {
  FlightSetup low = hover_at(1.5), high = hover_at(2.5);
  low.vehicle.sensors.flow->max_height = high.vehicle.sensors.flow->max_height = 2;
  EXPECT_GT(flows(low), 100);
  EXPECT_EQ(flows(high), 0);
}

// What a flight reads at its first instant is off by the drawn bias, and the estimator that begins
// in the air receives only the bias of the file.
TEST(SensorDrift, IsNotToldToTheEstimator) {
  FlightSetup setup = hover_at(1);
  setup.estimator = EstimatorKind::mambo;
  SensorFaults& gyro = *setup.vehicle.sensors.gyroscope;
  gyro.noise.setZero();
  gyro.delay = 0;
  gyro.scale.setOnes();
  gyro.bias = {0.1, 0, 0};
  const auto first_rate = [&] { return fly(setup).log.find("estimate.p")->values[0]; };
  EXPECT_NEAR(first_rate(), 0, 1e-6);
  gyro.turn_on_bias.setConstant(0.02);
  const double off = first_rate();
  EXPECT_GT(std::abs(off), 1e-4);
  EXPECT_LT(std::abs(off), 0.1);
  setup.flight = 1;
  EXPECT_NE(first_rate(), off);
  setup.real_sensors = false;
  EXPECT_NEAR(first_rate(), 0, 1e-6);
}

TEST(SensorDrift, FliesAloneAsTogether) {
  std::vector<FlightSetup> all;
  for (std::uint32_t i = 0; i < 6; ++i) {
    FlightSetup setup = hover_at(1.5);
    setup.vehicle.sensors.gps = typical_sensors().gps;
    setup.flight = i;
    setup.flown = setup.vehicle;
    Sensors& sensors = setup.flown->sensors;
    if (i % 2) sensors.gyroscope->turn_on_bias.setConstant(0.01);
    if (i % 3 == 0) sensors.accelerometer->bias_walk.setConstant(0.1);
    if (i > 2) sensors.barometer->faults.bias_walk.setConstant(1);
    if (i > 3) {
      sensors.gps->position.correlated_noise = {1, 1, 2};
      sensors.gps->position.correlation = 60;
    }
    sensors.flow->noise_per_height = 0.01 * (i % 2);
    if (i == 5) sensors.flow->max_height = 1.4;
    sensors.g_sensitivity.setConstant(1e-3 * (i % 3));
    if (i == 2) sensors.gyroscope->vibration.setConstant(1e-9);
    if (i == 3) sensors.accelerometer->vibration = {1e-7, 0, 2e-7};
    all.push_back(setup);
  }
  const std::vector<FlightResult> together = fly_all(all, 1);
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_STREQ(first_difference(together[i], fly(all[i])), "") << i;
}

TEST(SensorDrift, IsReadAndRefused) {
  const auto sensors = [](const std::string& text) {
    return parse_vehicle(vehicle_text("", "", "", text), "x.toml").sensors;
  };
  const Sensors read = sensors(
      "[sensors.gyroscope]\nrate_Hz = 200\nbias_turn_on_rad_per_s = 0.01\n"
      "bias_walk_rad_per_s_per_sqrt_s = [1e-4, 2e-4, 3e-4]\n"
      "g_sensitivity_rad_per_s_per_m_per_s2 = 2e-4\nvibration_rad_per_s_per_rad2_s2 = 1e-8\n"
      "[sensors.gps]\nrate_Hz = 5\ncorrelated_noise_m = [1, 1, 2]\ncorrelation_s = 60\n"
      "[sensors.flow]\nrate_Hz = 60\ngreatest_height_m = 4\n"
      "noise_per_height_rad_per_s_per_m = 0.02\n");
  EXPECT_EQ(read.gyroscope->turn_on_bias, Vector3d(0.01, 0.01, 0.01));
  EXPECT_EQ(read.gyroscope->bias_walk, Vector3d(1e-4, 2e-4, 3e-4));
  EXPECT_EQ(read.gyroscope->vibration, Vector3d(1e-8, 1e-8, 1e-8));
  EXPECT_EQ(read.g_sensitivity, Vector3d(2e-4, 2e-4, 2e-4));
  EXPECT_EQ(read.gps->position.correlated_noise, Vector3d(1, 1, 2));
  EXPECT_EQ(read.gps->position.correlation, 60);
  EXPECT_EQ(read.flow->max_height, 4);
  EXPECT_EQ(read.flow->noise_per_height, 0.02);
  EXPECT_EQ(ideal(read).flow->noise_per_height, 0);
  EXPECT_EQ(ideal(read).g_sensitivity, Vector3d(0, 0, 0));
  EXPECT_EQ(ideal(read).gyroscope->turn_on_bias, Vector3d(0, 0, 0));
  const auto refusal = [&](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { (void)sensors(text); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal("[sensors.gps]\nrate_Hz = 5\ncorrelated_noise_m = 1\n",
          "[sensors.gps] has correlated_noise_m but no correlation_s, expected both");
  refusal("[sensors.gps]\nrate_Hz = 5\ncorrelation_s = 1\n",
          "[sensors.gps] has correlation_s but no correlated_noise_m, expected both");
  refusal("[sensors.gps]\nrate_Hz = 5\nbias_turn_on_m = -1\n",
          "bias_turn_on_m in [sensors.gps] is -1, expected 0 or more");
  refusal("[sensors.gps]\nrate_Hz = 5\nvibration_m_per_rad2_s2 = 1\n", "vibration");
  refusal("[sensors.flow]\nrate_Hz = 5\ngreatest_height_m = 0.3\n",
          "greatest_height_m in [sensors.flow] is 0.3, expected more than least_height_m, 0.4");
}

}  // namespace
}  // namespace quadtune
