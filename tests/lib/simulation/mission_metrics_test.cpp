// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

#include "numbers.hpp"
#include "quadtune/simulation/flight_metrics.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/simulation/pack.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;

using testing::kInfinity;
using testing::kPi;

// first, first + step, … before last.
std::vector<double> times(double first, double last, double step) {
  std::vector<double> all;
  while (first + static_cast<double>(all.size()) * step < last)
    all.push_back(first + static_cast<double>(all.size()) * step);
  return all;
}

// One flight, a period at a time: what is not said is 0.
struct Flight {
  FlightMetrics<double> metrics;
  double dt = 0.01;
  double t = 0;
  StateVector<double> x = StateVector<double>::Zero();
  Estimate<double> estimate;
  Reference<double> reference;
  bool saturated = false;
  double power = 0;

  explicit Flight(const SettlingRule& rule = {}) : metrics(rule) {}
  void period() {
    metrics.add(t, dt, x, estimate, reference, saturated, power);
    t += dt;
  }
  [[nodiscard]] double operator[](Metric metric) const { return metrics.values()[metric]; }
};

TEST(Metrics, HaveNamesUnitsAndKeys) {
  EXPECT_THAT(
      metric_names(),
      ElementsAre("duration", "settling_time", "overshoot", "yaw_overshoot", "tracking_rms",
                  "tracking_max", "height_rms", "height_max", "yaw_rms", "yaw_max", "tilt_max",
                  "speed_max", "saturation_time", "energy", "estimate_rms", "estimate_max",
                  "position_drift", "final_distance", "touchdown_speed", "height_peak"));
  for (const std::string& name : metric_names()) EXPECT_EQ(name_of(*metric_of(name)), name);
  EXPECT_FALSE(metric_of("nonsense"));
  EXPECT_EQ(unit_of(Metric::touchdown_speed), "m/s");
  EXPECT_EQ(limit_key(Metric::settling_time), "settling_time_max_s");
  EXPECT_EQ(limit_key(Metric::tilt_max), "tilt_max_rad");
  EXPECT_EQ(limit_key(Metric::overshoot), "overshoot_max");
  EXPECT_EQ(limit_key(Metric::touchdown_speed), "touchdown_speed_max_m_per_s");
  EXPECT_EQ(limit_key(Metric::height_peak), "height_peak_max_m");
}

TEST(Metrics, NothingFlownHasNoFigures) {
  const MetricValues values = FlightMetrics<double>().values();
  EXPECT_EQ(values[Metric::duration], 0);
  for (const std::string& name : metric_names())
    EXPECT_EQ(std::isnan(values[*metric_of(name)]), name != "duration") << name;
}

// x(t) = 1 - e^(-ζ w t) (cos wd t + ζ w / wd sin wd t): overshoot e^(-π ζ/√(1 - ζ²)); it settles
// where its envelope's last crossing of the band says, found here by bisection on the closed form.
TEST(Metrics, SecondOrderStepHasItsOvershootAndSettlingTime) {
  for (const double zeta : {0.2, 0.5, 0.7}) {
    const double w = 3, wd = w * std::sqrt(1 - zeta * zeta);
    const auto response = [&](double t) {
      return 1 - std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
    };
    constexpr double kBand = 0.05, kStepTime = 1, kDt = 1e-3;
    double settled = 0;
    for (const double t : times(0, 20, 1e-5))
      if (std::abs(response(t) - 1) > kBand) settled = t;
    Flight flight({kBand, 0.05, 5});
    flight.dt = kDt;
    for (int i = 0; i < 21000; ++i) {
      const double since = i * kDt - kStepTime;
      flight.reference.position = since >= 0 ? Vector3d(0, 2, 0) : Vector3d(0, 1, 0);
      flight.x(1) = since > 0 ? 1 + response(since) : 1;
      flight.period();
    }
    const double overshoot = std::exp(-kPi * zeta / std::sqrt(1 - zeta * zeta));
    EXPECT_NEAR(flight[Metric::overshoot], overshoot, 1e-5) << zeta;
    EXPECT_NEAR(flight[Metric::settling_time], settled, 1.5 * kDt) << zeta;
    EXPECT_TRUE(std::isnan(flight[Metric::yaw_overshoot]));
    EXPECT_LT(flight[Metric::tracking_max], kBand);
  }
}

// Four periods by hand: a step of 2 m to the north, passed by 0.5 m, in the band from the third on.
TEST(Metrics, StepByHand) {
  Flight flight({0.1, 0.05, 0.02});
  flight.reference.position = {2, 0, -1};
  for (const double north : {0.0, 2.5, 2.05, 1.95}) {
    flight.x.head<3>() << north, 0, -1;
    flight.period();
  }
  EXPECT_NEAR(flight[Metric::settling_time], 0.02, 1e-15);  // two periods were outside
  EXPECT_NEAR(flight[Metric::overshoot], 0.25, 1e-15);
  // Tracking counts from 0.02 s on: the last two.
  EXPECT_NEAR(flight[Metric::tracking_rms], 0.05, 1e-12);
  EXPECT_NEAR(flight[Metric::tracking_max], 0.05, 1e-12);
  EXPECT_EQ(flight[Metric::height_max], 0);
  EXPECT_NEAR(flight[Metric::final_distance], 0.05, 1e-12);
  EXPECT_NEAR(flight[Metric::duration], 0.04, 1e-15);
}

TEST(Metrics, NeverSettledIsInfinite) {
  Flight flight({0.1, 0.05, 1});
  flight.reference.position = {1, 0, 0};
  for (int i = 0; i < 300; ++i) flight.period();
  EXPECT_EQ(flight[Metric::settling_time], kInfinity);
  EXPECT_EQ(flight[Metric::overshoot], 0);
  // Settled once and out again at the very end is not settled.
  Flight late({0.1, 0.05, 1});
  for (int i = 0; i < 300; ++i) {
    late.x(0) = i == 299 ? 0.2 : 0;
    late.period();
  }
  EXPECT_EQ(late[Metric::settling_time], kInfinity);
}

TEST(Metrics, ShortHoldsAreNotJudged) {
  Flight flight({0.1, 0.05, 1});
  for (int i = 0; i < 300; ++i) {  // a step of 1 m every half second, never followed
    flight.reference.position.x() = std::floor(i / 50.0);
    flight.period();
  }
  EXPECT_TRUE(std::isnan(flight[Metric::settling_time]));
  EXPECT_TRUE(std::isnan(flight[Metric::overshoot]));
  EXPECT_TRUE(std::isnan(flight[Metric::tracking_rms]));
}

// The worst of all holds counts, also one that was left before the end.
TEST(Metrics, TheWorstHoldCounts) {
  Flight flight({0.1, 0.05, 1});
  const auto hold = [&](double reference, int outside) {
    flight.reference.position.x() = reference;
    for (int i = 0; i < 200; ++i) {
      flight.x(0) = reference + (i < outside ? 0.5 : 0);
      flight.period();
    }
  };
  hold(0, 30);
  EXPECT_NEAR(flight[Metric::settling_time], 0.3, 1e-12);
  hold(3, 70);
  EXPECT_NEAR(flight[Metric::settling_time], 0.7, 1e-12);
  hold(6, 10);
  EXPECT_NEAR(flight[Metric::settling_time], 0.7, 1e-12);
  hold(9, 200);
  EXPECT_EQ(flight[Metric::settling_time], kInfinity);
  hold(12, 0);
  EXPECT_EQ(flight[Metric::settling_time], kInfinity);
}

// A reference that moves with its velocity steps nowhere, and holds only while it stands.
TEST(Metrics, MovingReferencesHoldWhenTheyStop) {
  Flight flight({0.1, 0.05, 1});
  for (int i = 0; i < 600; ++i) {
    const bool moves = i >= 200 && i < 400;
    flight.reference.position.x() = moves ? (i - 200) * 0.01 : (i < 200 ? 0 : 2);
    flight.reference.velocity.x() = moves ? 1 : 0;
    // It follows 0.3 m behind, catches up within 0.5 s of the stop and passes the end.
    flight.x(0) = flight.reference.position.x() - (moves || (i >= 400 && i < 450) ? 0.3 : -0.05);
    flight.period();
  }
  EXPECT_NEAR(flight[Metric::settling_time], 0.5, 0.011);
  EXPECT_TRUE(std::isnan(flight[Metric::overshoot]));  // no step
  EXPECT_NEAR(flight[Metric::tracking_max], 0.3, 1e-12);
}

// The same motion without its velocity in the reference, a jump of more than the band a period.
TEST(Metrics, JumpsOfMoreThanTheBandAreSteps) {
  Flight flight({0.005, 0.05, 0.1});
  for (int i = 0; i < 100; ++i) {
    flight.reference.position.x() = i * 0.01;
    flight.period();
  }
  EXPECT_TRUE(std::isnan(flight[Metric::tracking_rms]));
}

// With the velocity they are foreseen.
TEST(Metrics, FastReferencesDoNotStep) {
  Flight flight({0.005, 0.05, 0.1});
  flight.reference.velocity.x() = 1;
  for (int i = 0; i < 100; ++i) {
    flight.reference.position.x() = i * 0.01;
    flight.x(0) = flight.reference.position.x() - 0.25;
    flight.period();
  }
  EXPECT_NEAR(flight[Metric::tracking_rms], 0.25, 1e-12);
  EXPECT_TRUE(std::isnan(flight[Metric::settling_time]));
}

TEST(Metrics, YawStepGoesTheShorterWay) {
  Flight flight({0.1, 0.05, 1});
  flight.x(kAttitude + 2) = 3.0;
  flight.reference.yaw = 3.0 - 2 * kPi;  // the same direction
  for (int i = 0; i < 150; ++i) flight.period();
  EXPECT_EQ(flight[Metric::settling_time], 0);
  EXPECT_NEAR(flight[Metric::yaw_max], 0, 1e-12);
  flight.reference.yaw += 0.4;  // over the cut at π
  for (int i = 0; i < 300; ++i) {
    flight.x(kAttitude + 2) = 3.0 + (i < 50 ? 0 : i < 60 ? 0.5 : 0.38);
    flight.period();
  }
  EXPECT_NEAR(flight[Metric::yaw_overshoot], 0.25, 1e-9);
  EXPECT_NEAR(flight[Metric::settling_time], 0.6, 1e-9);
  EXPECT_NEAR(flight[Metric::yaw_max], 0.02, 1e-9);
  EXPECT_TRUE(std::isnan(flight[Metric::overshoot]));
}

TEST(Metrics, YawStepToTheLeftIsPassedToTheLeft) {
  Flight flight({0.1, 0.05, 1});
  for (int i = 0; i < 150; ++i) flight.period();
  flight.reference.yaw = -0.4;
  for (int i = 0; i < 300; ++i) {
    flight.x(kAttitude + 2) = i < 1 ? 0 : i < 50 ? -0.48 : -0.4;
    flight.period();
  }
  EXPECT_NEAR(flight[Metric::yaw_overshoot], 0.2, 1e-9);
}

TEST(Metrics, AttitudeFlightIsJudgedByItsHeight) {
  Flight flight({0.1, 0.05, 0});
  flight.reference.track_position = false;
  flight.reference.position = {0, 0, -1};
  flight.x.head<3>() << 50, 50, -1.2;
  for (int i = 0; i < 300; ++i) flight.period();
  EXPECT_NEAR(flight[Metric::tracking_rms], 0.2, 1e-12);
  EXPECT_NEAR(flight[Metric::height_rms], 0.2, 1e-12);
  EXPECT_TRUE(std::isnan(flight[Metric::settling_time]));
}

TEST(Metrics, OnlyFlightIsTracked) {
  Flight flight({0.1, 0.05, 0});
  for (const FlightPhase phase :
       {FlightPhase::start_up, FlightPhase::take_off, FlightPhase::flying, FlightPhase::off}) {
    flight.reference.phase = phase;
    flight.x(0) = phase == FlightPhase::flying ? 0.01 : 7;
    for (int i = 0; i < 100; ++i) flight.period();
  }
  EXPECT_NEAR(flight[Metric::tracking_max], 0.01, 1e-15);
  EXPECT_EQ(flight[Metric::settling_time], 0);
  EXPECT_EQ(flight[Metric::final_distance], 7);
  EXPECT_NEAR(flight[Metric::duration], 4, 1e-12);
}

TEST(Metrics, TiltSpeedSaturationAndEnergyByHand) {
  Flight flight;
  flight.power = 5;
  flight.x(kAttitude) = 0.3;
  flight.x(kAttitude + 1) = -0.4;
  flight.x.segment<3>(kVelocity) << 1, -2, 2;
  flight.period();
  flight.saturated = true;
  flight.x(kAttitude) = -0.49;
  flight.x(kAttitude + 1) = 0;
  flight.x.segment<3>(kVelocity).setZero();
  flight.power = 7;
  flight.period();
  flight.period();
  EXPECT_NEAR(flight[Metric::tilt_max], std::acos(std::cos(0.3) * std::cos(0.4)), 1e-15);
  EXPECT_EQ(flight[Metric::speed_max], 3);
  EXPECT_NEAR(flight[Metric::saturation_time], 0.02, 1e-15);
  EXPECT_NEAR(flight[Metric::energy], 0.05 + 0.14, 1e-15);
}

TEST(Metrics, TiltIsTheGreatestOfAll) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> roll(-kPi, kPi), pitch(-kPi / 2, kPi / 2);
  for (int trial = 0; trial < 50; ++trial) {
    Flight flight;
    double max = 0;
    const double scale = trial % 5 == 0 ? 1 : 1e-4;
    for (int i = 0; i < 50; ++i) {
      flight.x(kAttitude) = scale * roll(random);
      flight.x(kAttitude + 1) = scale * pitch(random);
      const Eigen::Matrix3d R_WB =
          rotation_of_euler(flight.x(kAttitude), flight.x(kAttitude + 1), 0.0);
      max = std::max(max, std::atan2(R_WB.col(2).head<2>().norm(), R_WB(2, 2)));
      flight.period();
    }
    EXPECT_NEAR(flight[Metric::tilt_max], max, 1e-14);
  }
}

TEST(Metrics, EstimateErrorAndDriftByHand) {
  Flight flight;
  flight.x.head<3>() << 1, 1, -1;
  flight.estimate.x.head<3>() << 1.5, 1, -1;  // off by (0.5, 0, 0)
  flight.period();
  flight.x(0) = 2;
  flight.estimate.x.head<3>() << 2.5 - 0.3, 1.4, -1.5;  // off by (0.2, 0.4, -0.5)
  flight.period();
  EXPECT_NEAR(flight[Metric::estimate_rms], std::sqrt((0.25 + 0.45) / 2), 1e-12);
  EXPECT_NEAR(flight[Metric::estimate_max], std::sqrt(0.45), 1e-12);
  EXPECT_NEAR(flight[Metric::position_drift], 0.5, 1e-12);  // by (-0.3, 0.4)
}

TEST(Metrics, TouchdownSpeedIsThatJustBeforeTheGround) {
  Flight flight;
  EXPECT_TRUE(std::isnan(flight[Metric::touchdown_speed]));
  const auto heights = [&](std::initializer_list<double> all) {
    for (const double height : all) {
      flight.x(2) = -height;
      flight.period();
    }
  };
  heights({0, 0.05, 0.01, 0});  // a hop that was no flight
  EXPECT_TRUE(std::isnan(flight[Metric::touchdown_speed]));
  heights({0.2, 0.04, 0.035, 0.02, 0.02});  // 5 mm in the period before the one that met the ground
  EXPECT_NEAR(flight[Metric::touchdown_speed], 0.5, 1e-9);
  heights({0.2, 0.04, 0.037, 0});  // slower: the worst stays
  EXPECT_NEAR(flight[Metric::touchdown_speed], 0.5, 1e-9);
  heights({0.2, 0.04, 0.03, 0});
  EXPECT_NEAR(flight[Metric::touchdown_speed], 1, 1e-9);
}

// 0.3 m above the reference during the take-off; a step down leaves the vehicle above its
// reference, but not above the highest one.
TEST(Metrics, HeightPeakIsAboveTheHighestReferenceSoFar) {
  Flight flight;
  flight.reference.phase = FlightPhase::start_up;
  flight.x(2) = -5;  // not flown: it does not count
  flight.period();
  EXPECT_TRUE(std::isnan(flight[Metric::height_peak]));
  const auto fly = [&](FlightPhase phase, double asked, double height) {
    flight.reference.phase = phase;
    flight.reference.position.z() = -asked;
    flight.x(2) = -height;
    flight.period();
    return flight[Metric::height_peak];
  };
  EXPECT_EQ(fly(FlightPhase::take_off, 1, 0.5), 0);
  EXPECT_NEAR(fly(FlightPhase::take_off, 1, 1.3), 0.3, 1e-12);
  EXPECT_NEAR(fly(FlightPhase::flying, 1, 1.1), 0.3, 1e-12);
  EXPECT_NEAR(fly(FlightPhase::flying, 2, 2.2), 0.3, 1e-12);
  EXPECT_NEAR(fly(FlightPhase::flying, 1, 2.1), 0.3, 1e-12);  // a step down by 1 m
  EXPECT_NEAR(fly(FlightPhase::flying, 1, 2.5), 0.5, 1e-12);
  EXPECT_NEAR(fly(FlightPhase::off, 1, 9), 0.5, 1e-12);
}

// An error of 0.2 m: settled within 0.3 m, not within 0.1 m; steps are found by 0.1 m still.
TEST(Metrics, SettledBandsWidenSettlingAlone) {
  for (const double settled : {0.0, 0.3}) {
    SettlingRule rule{0.1, 0.05, 1};
    rule.settled_band = settled;
    rule.settled_yaw_band = settled;
    Flight flight(rule);
    for (int k = 0; k < 400; ++k) {
      flight.reference.position.x() = k < 200 ? 0 : 0.25;
      flight.x(0) = k < 200 ? 0 : k < 300 ? -0.1 : 0.45;
      flight.x(5) = k < 200 ? 0 : 0.1;
      flight.period();
    }
    if (settled > 0)
      EXPECT_NEAR(flight[Metric::settling_time], 1.0, 1e-9);
    else
      EXPECT_EQ(flight[Metric::settling_time], INFINITY);
    EXPECT_NEAR(flight[Metric::overshoot], 0.2 / 0.35, 1e-9);
  }
}

TEST(Metrics, WhatIsNotFiniteSpoilsEverythingButTheDuration) {
  for (int where = 0; where < 4; ++where) {
    Flight flight({0.1, 0.05, 0});
    for (int i = 0; i < 10; ++i) flight.period();
    const double bad = where % 2 == 0 ? std::nan("") : -kInfinity;
    if (where == 0) flight.x(kRates) = bad;
    if (where == 1) flight.x(0) = bad;
    if (where == 2) flight.power = bad;
    if (where == 3) flight.estimate.x(11) = bad;
    flight.period();
    flight.x.setZero();
    flight.estimate.x.setZero();
    flight.power = 0;
    for (int i = 0; i < 10; ++i) flight.period();
    for (const std::string& name : metric_names()) {
      if (name == "duration")
        EXPECT_NEAR(flight[Metric::duration], 0.21, 1e-12);
      else
        EXPECT_TRUE(std::isnan(flight[*metric_of(name)])) << name << where;
    }
  }
}

// --- several flights at once ---

// Flights of random walks with steps, moves and phases; lane i of a pack is flight i.
TEST(Metrics, LanesAreFlightsOfTheirOwn) {
  constexpr int kLanes = 4;
  using P = Pack<kLanes>;
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0, 1);
  const SettlingRule rule{0.3, 0.2, 0.3};
  FlightMetrics<P> packed(rule);
  std::array<FlightMetrics<double>, kLanes> single;
  single.fill(FlightMetrics<double>(rule));
  std::array<StateVector<double>, kLanes> x;
  x.fill(StateVector<double>::Zero());
  std::array<Reference<double>, kLanes> reference;
  std::array<Estimate<double>, kLanes> estimate;
  const double dt = 0.01;
  for (int period = 0; period < 3000; ++period) {
    const double t = period * dt;
    StateVector<P> px;
    Estimate<P> pestimate;
    Reference<P> preference;
    Mask<kLanes> saturated(false), counts(true);
    P power(0);
    const FlightPhase phase = period < 100    ? FlightPhase::take_off
                              : period < 2700 ? FlightPhase::flying
                                              : FlightPhase::off;
    const bool track = period < 1500 || period > 1800;
    for (int i = 0; i < kLanes; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const bool flies = i != 2 || period < 2000;  // the third ends early
      Reference<double>& r = reference[n];
      r.velocity.setZero();
      if (random() % 150 == 0) r.position = Vector3d(noise(random), noise(random), noise(random));
      if (random() % 300 == 0) r.yaw += 3 * noise(random);
      if (period % 700 < 200) {
        r.velocity = Vector3d(0.5, 0, 0.1 * i);
        r.position += r.velocity * dt;
      }
      r.phase = phase;
      r.track_position = track;
      for (int k = 0; k < 12; ++k) x[n](k) += 0.02 * noise(random);
      x[n].head<3>() += 0.05 * (r.position - x[n].head<3>());
      x[n](5) += 0.05 * (r.yaw - x[n](5));
      estimate[n].x = x[n] * 1.01;
      const bool limit = random() % 5 == 0;
      const double watts = 5 + noise(random);
      if (flies) single[n].add(t, dt, x[n], estimate[n], r, limit, watts);
      for (int k = 0; k < 12; ++k) {
        set_lane(px(k), i, x[n](k));
        set_lane(pestimate.x(k), i, estimate[n].x(k));
      }
      for (int k = 0; k < 3; ++k) {
        set_lane(preference.position(k), i, r.position(k));
        set_lane(preference.velocity(k), i, r.velocity(k));
      }
      set_lane(preference.yaw, i, r.yaw);
      set_lane(saturated, i, limit);
      set_lane(counts, i, flies);
      set_lane(power, i, watts);
    }
    preference.phase = phase;
    preference.track_position = track;
    packed.add(t, dt, px, pestimate, preference, saturated, power, counts);
  }
  int figures = 0;
  for (int i = 0; i < kLanes; ++i) {
    const MetricValues want = single[static_cast<std::size_t>(i)].values();
    const MetricValues got = packed.values(i);
    for (std::size_t k = 0; k < kMetrics; ++k) {
      if (std::isnan(want.value[k])) {
        EXPECT_TRUE(std::isnan(got.value[k]));
      } else {
        EXPECT_EQ(got.value[k], want.value[k]) << i << metric_names()[k];
        ++figures;
      }
    }
  }
  EXPECT_GT(figures, 4 * 15);
}

// Periods that do not count are as if they had not been.
TEST(Metrics, WhatDoesNotCountChangesNothing) {
  Flight with({0.1, 0.05, 1}), without({0.1, 0.05, 1});
  for (int i = 0; i < 300; ++i) {
    for (Flight* flight : {&with, &without}) {
      flight->reference.position = {1, 0, -1};
      flight->x.head<3>() << (i < 150 ? 0.5 : 1.02), 0, -1;
      flight->estimate.x(1) = 0.01 * i;
      flight->period();
    }
    if (i % 50 != 20) continue;
    Reference<double> other = with.reference;
    other.position.setConstant(7);
    other.phase = i < 100 ? FlightPhase::off : FlightPhase::flying;
    const StateVector<double> nowhere = StateVector<double>::Constant(std::nan(""));
    with.metrics.add(with.t, 0.01, nowhere, with.estimate, other, true, 100, false);
    with.metrics.add(with.t, 0.01, 9 * with.x, {}, other, true, 100, false);
  }
  EXPECT_NEAR(without[Metric::settling_time], 1.5, 1e-12);
  const MetricValues want = without.metrics.values(), got = with.metrics.values();
  for (std::size_t k = 0; k < kMetrics; ++k) {
    EXPECT_EQ(std::isnan(got.value[k]), std::isnan(want.value[k])) << metric_names()[k];
    if (!std::isnan(want.value[k])) {
      EXPECT_EQ(got.value[k], want.value[k]) << metric_names()[k];
    }
  }
}

TEST(Metrics, ASpoiltLaneSpoilsNoOther) {
  using P = Pack<4>;
  FlightMetrics<P> metrics(SettlingRule{0.1, 0.05, 0});
  StateVector<P> x = StateVector<P>::Zero();
  for (int i = 0; i < 50; ++i) {
    if (i == 20) set_lane(x(3), 1, std::nan(""));
    metrics.add(0.01 * i, 0.01, x, Estimate<P>(), Reference<P>(), Mask<4>(false), P(1));
  }
  EXPECT_TRUE(std::isnan(metrics.values(1)[Metric::tilt_max]));
  EXPECT_NEAR(metrics.values(0)[Metric::energy], 0.5, 1e-12);
  EXPECT_EQ(metrics.values(2)[Metric::settling_time], 0);
}

// --- the verdict ---

MetricValues flown_for(double duration) {
  MetricValues values;
  values[Metric::duration] = duration;
  return values;
}

TEST(Judge, HoldsEveryLimitAgainstItsFigure) {
  Mission mission;
  mission.duration = 10;
  mission.limits = {{Metric::settling_time, 3}, {Metric::tilt_max, 0.2}};
  MetricValues values = flown_for(10);
  values[Metric::settling_time] = 3;  // the limit itself passes
  values[Metric::tilt_max] = 0.21;
  Verdict verdict = judge(mission, values);
  ASSERT_EQ(verdict.checks.size(), 3u);
  EXPECT_EQ(verdict.checks[0].metric, Metric::duration);
  EXPECT_TRUE(verdict.checks[0].at_least);
  EXPECT_TRUE(verdict.checks[0].ok);
  EXPECT_EQ(verdict.checks[1].metric, Metric::settling_time);
  EXPECT_EQ(verdict.checks[1].bound, 3);
  EXPECT_EQ(verdict.checks[1].value, 3);
  EXPECT_TRUE(verdict.checks[1].ok);
  EXPECT_FALSE(verdict.checks[2].ok);
  EXPECT_FALSE(verdict.ok);
  values[Metric::tilt_max] = 0.1;
  EXPECT_TRUE(judge(mission, values).ok);
}

TEST(Judge, FiguresThatAreNotThereFail) {
  Mission mission;
  mission.duration = 10;
  for (const double value : {std::nan(""), kInfinity}) {
    mission.limits = {{Metric::settling_time, 1e12}};
    MetricValues values = flown_for(10);
    values[Metric::settling_time] = value;
    EXPECT_FALSE(judge(mission, values).ok);
  }
}

TEST(Judge, AFlightThatEndedEarlyFails) {
  Mission mission;
  mission.duration = 10;
  EXPECT_TRUE(judge(mission, flown_for(9.9)).ok);
  EXPECT_FALSE(judge(mission, flown_for(9.8)).ok);
  EXPECT_FALSE(judge(mission, flown_for(std::nan(""))).ok);
  EXPECT_FALSE(judge(mission, MetricValues()).ok);
}

}  // namespace
}  // namespace quadtune
