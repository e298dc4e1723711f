// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/sensor_channel.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "matrix_near.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::MatrixNear;

using Three = SensorChannel<1, 3>;
using One = SensorChannel<1, 1>;
using Sample3 = Sample<Vector3<Pack<1>>, Pack<1>>;
using Sample1 = Sample<Pack<1>, Pack<1>>;

SensorFaults clean(double rate) {
  SensorFaults faults;
  faults.rate = rate;
  return faults;
}

One::Values one(double x) { return One::Values(Pack<1>(x)); }

// A channel of one axis under a loop of period dt, fed with what `truth` says of the time.
template <class Truth, class Watch>
void run(const SensorFaults& faults, double dt, int periods, const Truth& truth, const Watch& watch,
         std::uint32_t flight = 0) {
  One channel({faults}, 40);
  Sample1 sample;
  const RandomSource<1> source{3, {flight}};
  for (int k = 0; k <= periods; ++k) {
    const double now = k * dt;
    while (channel.due(now)) channel.take(one(truth(channel.next())), source);
    channel.deliver(now, dt, sample);
    watch(now, lane(sample.value, 0), sample.fresh.bits, lane(sample.age, 0));
  }
}

TEST(SensorChannel, ScalesThenShiftsEachAxis) {
  SensorFaults faults = clean(100);
  faults.scale = {1.1, 0.9, -2};
  faults.bias = {0.5, -0.25, 0};
  Three channel({faults}, 0);
  channel.take(Three::Values(1.0, 2.0, 3.0), {});
  Sample3 sample;
  channel.deliver(0, 0.01, sample);
  EXPECT_THAT(
      Vector3d(lane(sample.value(0), 0), lane(sample.value(1), 0), lane(sample.value(2), 0)),
      MatrixNear(Vector3d(1.6, 1.55, -6), 1e-15));
  EXPECT_TRUE(sample.fresh.bits);
}

TEST(SensorChannel, LimitsThenRounds) {
  SensorFaults faults = clean(100);
  faults.limit = 5;
  faults.quantum = 0.5;
  const std::vector<std::pair<double, double>> pairs = {
      {0.2, 0}, {0.26, 0.5}, {-0.26, -0.5}, {0.25, 0}, {4.9, 5}, {7, 5}, {-1e9, -5}};
  for (const auto& pair : pairs)
    run(
        faults, 0.01, 0, [&](double) { return pair.first; },
        [&](double, double value, bool fresh, double) {
          EXPECT_TRUE(fresh);
          EXPECT_EQ(value, pair.second) << pair.first;
        });
}

// No echo is not the lower limit: NaN goes through limits and steps.
TEST(SensorChannel, LetsNoEchoThrough) {
  SensorFaults faults = clean(100);
  faults.limit = 5;
  faults.quantum = 0.5;
  faults.noise.setConstant(0.1);
  run(
      faults, 0.01, 3, [](double) { return std::nan(""); },
      [](double, double value, bool fresh, double) {
        EXPECT_TRUE(fresh);
        EXPECT_TRUE(std::isnan(value));
      });
}

TEST(SensorChannel, NoiseIsWhiteAndNormalOnEveryAxis) {
  SensorFaults faults = clean(200);
  faults.noise = {0.1, 2, 5};
  Three channel({faults}, 12);
  Sample3 sample;
  constexpr int kCount = 200000;
  Eigen::MatrixXd values(kCount, 3);
  for (int k = 0; k < kCount; ++k) {
    channel.take(Three::Values(1.0, 1.0, 1.0), RandomSource<1>{5, {2}});
    channel.deliver(k * 0.005, 0.005, sample);
    for (int i = 0; i < 3; ++i) values(k, i) = (lane(sample.value(i), 0) - 1) / faults.noise(i);
  }
  const double root = std::sqrt(static_cast<double>(kCount));
  const Eigen::MatrixXd covariance = values.transpose() * values / kCount;
  const Eigen::MatrixXd next =
      values.topRows(kCount - 1).transpose() * values.bottomRows(kCount - 1) / kCount;
  EXPECT_LT(values.colwise().mean().cwiseAbs().maxCoeff(), 5 / root);
  EXPECT_THAT(covariance, MatrixNear(Eigen::MatrixXd::Identity(3, 3), 5 * std::sqrt(2.0) / root));
  EXPECT_THAT(next, MatrixNear(Eigen::MatrixXd::Zero(3, 3), 5 / root));
}

// What is taken at the n-th period comes n periods later, with its age.
TEST(SensorChannel, DelaysByWholePeriods) {
  for (const int late : {0, 1, 3, 17}) {
    SensorFaults faults = clean(200);
    faults.delay = late * 0.005;
    run(
        faults, 0.005, 100, [](double t) { return t; },
        [&](double now, double value, bool fresh, double age) {
          EXPECT_EQ(fresh, now >= late * 0.005 - 1e-12) << late << " " << now;
          if (!fresh) return;
          EXPECT_NEAR(value, now - late * 0.005, 1e-12);
          EXPECT_NEAR(age, late * 0.005, 1e-12);
        });
  }
}

// 60 samples in every second of a loop at 200 Hz, and none lost or added in 1000 s.
TEST(SensorChannel, KeepsItsRateUnderAnotherClock) {
  std::vector<int> in_second(1001, 0);
  double last = -1, longest = 0;
  run(
      clean(60), 0.005, 200000, [](double t) { return t; },
      [&](double now, double value, bool fresh, double age) {
        if (!fresh) {
          EXPECT_LT(age, 1 / 60.0 + 1e-9);
          return;
        }
        if (last >= 0) longest = std::max(longest, std::abs(value - last - 1 / 60.0));
        last = value;
        EXPECT_LE(now - value, 0.005);  // taken within this period
        EXPECT_NEAR(age, now - value, 1e-9);
        ++in_second[static_cast<std::size_t>(std::floor(now + 1e-9))];
      });
  EXPECT_LT(longest, 1e-9);
  for (std::size_t s = 0; s < 1000; ++s) ASSERT_EQ(in_second[s], 60) << s;
}

// A sensor that is faster than the loop, and late: the newest that has arrived counts, and the
// queue holds what is on its way however many that are.
TEST(SensorChannel, HandsOverTheNewestOfSeveral) {
  for (const double delay : {0.0, 0.0004, 0.003, 0.0123}) {
    SensorFaults faults = clean(5000);
    faults.delay = delay;
    run(
        faults, 0.01, 200, [](double t) { return t; },
        [&](double now, double value, bool fresh, double age) {
          const double newest = std::floor((now - delay) * 5000 + 1e-6) / 5000;
          EXPECT_EQ(fresh, newest >= 0) << now;
          if (!fresh) return;
          EXPECT_NEAR(value, newest, 1e-9);
          EXPECT_NEAR(age, now - newest, 1e-9);
        });
  }
}

TEST(SensorChannel, LosesItsShareAndKeepsTheLastValue) {
  SensorFaults faults = clean(200);
  faults.dropout = 0.3;
  int come = 0, both = 0;
  bool before = false;
  double last = 0, expected_age = 0;
  run(
      faults, 0.005, 99999, [](double t) { return t; },
      [&](double now, double value, bool fresh, double age) {
        come += fresh ? 1 : 0;
        both += fresh && before ? 1 : 0;
        before = fresh;
        if (fresh) last = now;
        expected_age = fresh ? 0 : expected_age + 0.005;
        ASSERT_NEAR(value, last, 1e-9);
        ASSERT_NEAR(age, expected_age, 1e-9);
      });
  EXPECT_NEAR(come, 70000, 5 * std::sqrt(100000 * 0.3 * 0.7));
  EXPECT_NEAR(both, 49000, 5 * std::sqrt(100000 * 0.7 * 0.3 * 2));  // one does not know the other
  faults.dropout = 1;
  run(
      faults, 0.005, 1000, [](double t) { return t; },
      [](double, double, bool fresh, double) { EXPECT_FALSE(fresh); });
}

TEST(SensorChannel, NothingToMeasureIsNoSample) {
  One channel({clean(100)}, 0);
  Sample1 sample;
  channel.take(one(4), {});
  channel.deliver(0, 0.01, sample);
  channel.take(one(5), {}, Mask<1>(true));
  channel.deliver(0.01, 0.01, sample);
  EXPECT_FALSE(sample.fresh.bits);
  EXPECT_EQ(lane(sample.value, 0), 4);
  EXPECT_NEAR(lane(sample.age, 0), 0.01, 1e-15);
}

// y" + 2 ζ w y' + w² y = w² u for u = r t from rest: with a = ζ w and b = w √(1-ζ²),
// y = r (t - 2ζ/w + e^(-at) (2ζ/w cos bt + (2ζ² - 1)/b sin bt)).
double ramp_response(double w, double zeta, double t) {
  const double a = zeta * w, b = w * std::sqrt(1 - zeta * zeta);
  return t - 2 * zeta / w +
         std::exp(-a * t) *
             (2 * zeta / w * std::cos(b * t) + (2 * zeta * zeta - 1) / b * std::sin(b * t));
}

TEST(SensorChannel, RespondsToARampAsTheFormulaSays) {
  for (const double w : {5.0, 190.0, 2000.0, 1e5})
    for (const double zeta : {0.1, 0.707, 0.95}) {
      SensorFaults faults = clean(200);
      faults.natural_frequency = w;
      faults.damping = zeta;
      run(
          faults, 0.005, 400, [](double t) { return 3 * t; },
          [&](double now, double value, bool, double) {
            ASSERT_NEAR(value, 3 * ramp_response(w, zeta, now), 1e-9) << w << " " << zeta;
          });
    }
}

// A step between two samples is a ramp there: two ramps, one a sample later.
TEST(SensorChannel, RespondsToAStepBetweenSamples) {
  SensorFaults faults = clean(200);
  faults.natural_frequency = 190;
  run(
      faults, 0.005, 100, [](double t) { return t > 0.001 ? 2.0 : 0.0; },
      [&](double now, double value, bool, double) {
        const double before = ramp_response(190, 0.707, now);
        const double after = now < 0.005 ? 0 : ramp_response(190, 0.707, now - 0.005);
        ASSERT_NEAR(value, 2 * (before - after) / 0.005, 1e-10);
      });
}

TEST(SensorChannel, ResponseBeginsAtRestOnTheTruth) {
  SensorFaults faults = clean(100);
  faults.natural_frequency = 20;
  run(
      faults, 0.01, 100, [](double) { return 7.0; },
      [](double, double value, bool, double) { ASSERT_NEAR(value, 7, 1e-13); });
}

// Echoes that stay away for a while do not spoil the response for good.
TEST(SensorChannel, ResponseComesBackAfterNoEcho) {
  SensorFaults faults = clean(100);
  faults.natural_frequency = 20;
  run(
      faults, 0.01, 100, [](double t) { return t < 0.2 || t > 0.5 ? 1 + t : std::nan(""); },
      [](double now, double value, bool, double) {
        EXPECT_EQ(std::isnan(value), now > 0.195 && now < 0.505) << now;
        if (now > 0.9) {
          EXPECT_NEAR(value, 1 + now - 2 * 0.707 / 20, 0.01);
        }
      });
}

TEST(SensorChannel, EachLaneIsTheSensorAlone) {
  std::array<SensorFaults, 4> faults;
  faults.fill(clean(60));
  faults[0].noise = {1, 2, 3};
  faults[1].natural_frequency = 50;
  faults[1].bias = {1, 0, 0};
  faults[2].quantum = 0.25;
  faults[2].dropout = 0.5;
  faults[3].limit = 0.5;
  SensorChannel<4, 3> together(faults, 8);
  std::vector<Three> alone;
  alone.reserve(4);
  for (const SensorFaults& f : faults) alone.emplace_back(std::array<SensorFaults, 1>{f}, 8);
  Sample<Vector3<Pack<4>>, Pack<4>> sample;
  sample.value.setConstant(Pack<4>(0));
  std::array<Sample3, 4> samples;
  for (Sample3& s : samples) s.value.setConstant(Pack<1>(0));
  const RandomSource<4> source{7, {0, 5, 2, 9}};
  for (int k = 0; k < 1000; ++k) {
    const double now = k * 0.005;
    while (together.due(now)) {
      const double t = together.next();
      const auto truth = [&](std::size_t l) {
        const double none = l == 1 && t > 1 && t < 2 ? std::nan("") : 0;
        return Vector3d(std::sin(t) + none, std::cos(3 * t), static_cast<double>(l));
      };
      Vector3<Pack<4>> u;
      Mask<4> lost;
      for (std::size_t l = 0; l < 4; ++l) {
        const bool gone = l == 0 && k % 7 == 0;
        set_lane(lost, static_cast<int>(l), gone);
        for (int i = 0; i < 3; ++i) set_lane(u(i), static_cast<int>(l), truth(l)(i));
        alone[l].take(Three::Values(truth(l).x(), truth(l).y(), truth(l).z()),
                      RandomSource<1>{7, {source.flight[l]}}, Mask<1>(gone));
      }
      together.take(u, source, lost);
    }
    together.deliver(now, 0.005, sample);
    for (std::size_t l = 0; l < 4; ++l) {
      const int at = static_cast<int>(l);
      alone[l].deliver(now, 0.005, samples[l]);
      ASSERT_EQ(lane(sample.fresh, at), samples[l].fresh.bits);
      ASSERT_EQ(lane(sample.age, at), lane(samples[l].age, 0));
      for (int i = 0; i < 3; ++i) {
        const double a = lane(sample.value(i), at), b = lane(samples[l].value(i), 0);
        ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << k << " " << l << " " << a << b;
      }
    }
  }
}

}  // namespace
}  // namespace quadtune
