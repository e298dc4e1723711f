// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/air.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

template <int N>
Vector3d lane_of(const Vector3<Pack<N>>& wind, int l) {
  return {lane(wind(0), l), lane(wind(1), l), lane(wind(2), l)};
}

// The numbers of [MIL-F-8785C] at low altitude, worked by hand in feet for 6 m: h = 19.685 ft,
// 0.177 + 0.000823 h = 0.193201.
TEST(Wind, DrydensNumbersAreThoseOfTheirSource) {
  Wind wind;
  wind.turbulence = 10;
  wind.mean = {3, 4, 1};
  const DrydenNumbers numbers = dryden_numbers(wind);
  const double across = 19.685039 / std::pow(0.193200787, 1.2) * 0.3048;
  EXPECT_THAT(numbers.sigma, MatrixNear(Vector3d(1 / std::pow(0.193200787, 0.4),
                                                 1 / std::pow(0.193200787, 0.4), 1),
                                        1e-7));
  EXPECT_THAT(numbers.length, MatrixNear(Vector3d(across, across, 6), 1e-5));
  EXPECT_THAT(numbers.tau, MatrixNear(Vector3d(across / 5, across / 5, 1.2), 1e-6));
  wind.mean.setZero();  // a vehicle that hovers in still air lets the turbulence pass at 1 m/s
  EXPECT_THAT(dryden_numbers(wind).tau, MatrixNear(Vector3d(across, across, 6), 1e-5));
}

TEST(Wind, GustIsOneMinusCosine) {
  Wind wind;
  wind.mean = {2, 0, -1};
  wind.gust.velocity = {4, -6, 1};
  wind.gust.start = 1;
  wind.gust.length = 0.5;
  WindModel<1> model({wind}, 0.01, 0);
  EXPECT_TRUE(model.windy());
  for (std::uint64_t k = 0; k < 200; ++k) {
    const double t = static_cast<double>(k) * 0.01;
    const double phase = (t - 1) / 0.5;
    const double share =
        phase > 0 && phase < 1 ? 0.5 * (1 - std::cos(2 * std::numbers::pi * phase)) : 0;
    EXPECT_THAT(lane_of(model.at(k, t, {}), 0),
                MatrixNear(Vector3d(wind.mean + wind.gust.velocity * share), 1e-14));
  }
  EXPECT_FALSE((WindModel<1>({Wind{}}, 0.01, 0).windy()));
}

// Turbulence over many flights at some samples: a standard deviation is known to 1/√(2 flights).
constexpr std::uint32_t kFlights = 20000;

struct Turbulence {
  std::vector<std::vector<Vector3d>> at;  // by sample asked for, then by flight

  Turbulence(const Wind& wind, double dt, const std::vector<std::uint64_t>& samples) {
    for (std::uint32_t flight = 0; flight < kFlights; flight += 8) {
      std::array<Wind, 8> winds;
      winds.fill(wind);
      WindModel<8> model(winds, dt, 3);
      RandomSource<8> source{11, {}};
      for (std::uint32_t l = 0; l < 8; ++l) source.flight[l] = flight + l;
      std::size_t next = 0;
      at.resize(samples.size());
      for (std::uint64_t k = 0; next < samples.size(); ++k) {
        const Vector3<Pack<8>> now = model.at(k, static_cast<double>(k) * dt, source);
        if (k != samples[next]) continue;
        for (int l = 0; l < 8; ++l) at[next].push_back(lane_of(now, l) - wind.mean);
        ++next;
      }
    }
  }

  // Mean of the products of two directions' winds in two samples.
  [[nodiscard]] double covariance(std::size_t i, const Vector3d& a, std::size_t j,
                                  const Vector3d& b) const {
    double sum = 0;
    for (std::size_t n = 0; n < at[i].size(); ++n) sum += a.dot(at[i][n]) * b.dot(at[j][n]);
    return sum / static_cast<double>(at[i].size());
  }
};

// Standard deviations from the first sample on, and what is left of them after a lag s:
// along e^(-s/τ), across and up e^(-s/τ) (1 - s/2τ), whatever the period it is sampled with.
TEST(Wind, TurbulenceHasTheSpectrumOfDryden) {
  Wind wind;
  wind.turbulence = 10;
  wind.turbulence_height = 20;
  wind.mean = {6, 8, 0};
  const DrydenNumbers numbers = dryden_numbers(wind);
  const Vector3d along(0.6, 0.8, 0), across(-0.8, 0.6, 0), up(0, 0, -1);
  const std::array<Vector3d, 3> axes = {along, across, up};
  for (const double dt : {1.0, 0.1}) {
    const auto samples = [&](double t) { return static_cast<std::uint64_t>(std::lround(t / dt)); };
    const std::vector<double> times = {0, 1, 3, 8};
    const Turbulence turbulence(
        wind, dt, {samples(times[0]), samples(times[1]), samples(times[2]), samples(times[3])});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double variance = std::pow(numbers.sigma(static_cast<Eigen::Index>(axis)), 2);
      const double tau = numbers.tau(static_cast<Eigen::Index>(axis));
      const double error = 5 * std::sqrt(2.0 / kFlights) * variance;
      for (std::size_t i = 0; i < times.size(); ++i) {
        EXPECT_NEAR(turbulence.covariance(i, axes[axis], i, axes[axis]), variance, error);
        const double s = times[i] / tau;
        const double left = std::exp(-s) * (axis == 0 ? 1 : 1 - s / 2);
        EXPECT_NEAR(turbulence.covariance(0, axes[axis], i, axes[axis]), variance * left, error)
            << "axis " << axis << " lag " << times[i] << " dt " << dt;
      }
      const std::size_t other = (axis + 1) % 3;  // and the axes know nothing of each other
      EXPECT_NEAR(turbulence.covariance(2, axes[axis], 2, axes[other]), 0, error);
    }
  }
}

// Two samples of one stage are one sample over twice the time.
TEST(Wind, TwoSamplesMakeOne) {
  struct Matrices {
    Eigen::Matrix2d A, Q;
    explicit Matrices(const DrydenStage<double>& stage) {
      A << stage.decay, 0, stage.coupling, stage.decay;
      Eigen::Matrix2d L;
      L << stage.noise_11, 0, stage.noise_21, stage.noise_22;
      Q = L * L.transpose();
    }
  };
  const Eigen::Matrix2d P = (Eigen::Matrix2d() << 1, 0.5, 0.5, 0.5).finished();
  for (const double x : {1e-4, 0.01, 0.3, 5.0}) {
    const Matrices one(dryden_stage(x)), two(dryden_stage(2 * x));
    EXPECT_THAT(Eigen::Matrix2d(one.A * one.A), MatrixNear(two.A, 1e-14));
    EXPECT_THAT(Eigen::Matrix2d(one.A * one.Q * one.A.transpose() + one.Q),
                MatrixNear(two.Q, 1e-14));
    EXPECT_THAT(Eigen::Matrix2d(one.A * P * one.A.transpose() + one.Q), MatrixNear(P, 1e-14));
  }
}

// A vehicle that flies with the mean wind meets what one that hovers in still air meets; one that
// flies against it meets the scales of twice the wind.
TEST(Wind, TurbulencePassesWithTheAirspeed) {
  const auto gusts = [](double mean, double velocity, double dt) {
    Wind wind;
    wind.turbulence = 10;
    wind.mean = {mean, 0, 0};
    WindModel<1> model({wind}, dt, 3);
    std::vector<double> all;
    for (std::uint64_t k = 0; k < 200; ++k) {
      const Vector3d now = lane_of(
          model.at(k, static_cast<double>(k) * dt, {5, {}}, Vector3<Pack<1>>(velocity, 0.0, 3.0)),
          0);
      for (int i = 0; i < 3; ++i) all.push_back(now(i) - wind.mean(i));
    }
    return all;
  };
  const auto expect_near = [](const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-9) << i;
  };
  expect_near(gusts(8, 8, 0.1), gusts(0, 0, 0.1));
  expect_near(gusts(8, -8, 0.1), gusts(16, 0, 0.1));
  expect_near(gusts(8, -8, 0.1), gusts(8, 0, 0.2));  // L/V halves as the sample time doubles
}

// The wind at 6 m that makes the turbulence is the mean wind.
TEST(Wind, WordsHaveTheMeanWindOfTheirTurbulence) {
  for (const auto& [word, speed] : std::vector<std::pair<const char*, double>>{
           {"light", 7.7}, {"moderate", 15.4}, {"severe", 23.2}}) {
    const Wind wind = parse_wind(word, "--wind");
    EXPECT_EQ(wind.turbulence, speed);
    EXPECT_EQ(wind.mean, Vector3d(speed, 0, 0));
    // L across is 19.685/0.1932^1.2 ft = 43.2 m, L up 6 m.
    EXPECT_THAT(dryden_numbers(wind).tau,
                MatrixNear(Vector3d(43.15 / speed, 43.15 / speed, 6 / speed), 1e-2));
  }
  EXPECT_EQ(parse_wind("calm", "--wind").mean, Vector3d(0, 0, 0));
  EXPECT_EQ(parse_wind("turbulence=5", "--wind").mean, Vector3d(0, 0, 0));
}

TEST(Wind, EachLaneHasItsOwn) {
  std::array<Wind, 4> winds;
  winds[0].mean = {1, 2, 3};
  winds[1].turbulence = 7.7;
  winds[2].gust = {{0, 5, 0}, 0.1, 1};
  WindModel<4> together(winds, 0.01, 32);
  RandomSource<4> source{5, {9, 8, 7, 6}};
  std::array<WindModel<1>, 4> alone;
  for (std::size_t l = 0; l < 4; ++l) alone[l] = WindModel<1>({winds[l]}, 0.01, 32);
  for (std::uint64_t k = 0; k < 100; ++k) {
    const double t = static_cast<double>(k) * 0.01;
    const Vector3<Pack<4>> wind = together.at(k, t, source);
    for (std::size_t l = 0; l < 4; ++l)
      EXPECT_THAT(lane_of(wind, static_cast<int>(l)),
                  MatrixNear(lane_of(alone[l].at(k, t, {5, {source.flight[l]}}), 0), 0));
  }
}

TEST(Wind, RefusesWhatIsNoWind) {
  const auto refusal = [](const std::function<void(Wind&)>& change, const std::string& message) {
    Wind wind;
    change(wind);
    EXPECT_THAT([&] { (void)dryden_numbers(wind); }, ThrowsMessage<InvalidInput>(StrEq(message)));
  };
  const double nan = std::nan("");
  refusal([](Wind& w) { w.turbulence = -1; }, "wind: turbulence is -1 m/s, expected 0 or more");
  refusal([&](Wind& w) { w.turbulence = nan; }, "wind: turbulence is nan m/s, expected 0 or more");
  refusal(
      [](Wind& w) { w.turbulence_height = 2; },
      "wind: the height of the turbulence is 2 m, expected 3 to 300 m, where its scales are known");
  refusal([&](Wind& w) { w.mean.y() = nan; },
          "wind: a velocity is not finite, expected finite numbers [m/s]");
  refusal([](Wind& w) { w.gust.velocity.x() = INFINITY; },
          "wind: a velocity is not finite, expected finite numbers [m/s]");
  refusal(
      [](Wind& w) { w.gust.length = 0; },
      "wind: the gust begins at 0 s and lasts 0 s, expected a finite time and a positive duration");
  refusal([&](Wind& w) { w.gust.start = nan; },
          "wind: the gust begins at nan s and lasts 1 s, expected a finite time and a positive "
          "duration");
}

}  // namespace
}  // namespace quadtune
