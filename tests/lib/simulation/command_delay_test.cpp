// SPDX-License-Identifier: Apache-2.0
#include "simulation/loop/command_delay.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "same_flight.hpp"
#include "vehicle_text.hpp"

namespace quadtune {
namespace {

using testing::first_difference;
using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
using testing::vehicle_text;

constexpr double kPeriod = 0.005;

// Motor 1 goes from standing to a tenth of its range at 0.1 s.
FlightSetup one_motor(double delay, double lag) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.vehicle.motor.delay = delay;
  for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = lag;
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.mission = parse_mission(
      "name = \"one\"\nduration_s = 0.3\n[[motors]]\nat_s = 0.1\nfor_s = 0.15\nmotors = [1]\n"
      "share = 0.1\n",
      "one.toml");
  setup.step = 0.0005;
  setup.log = true;
  return setup;
}

// w = c (1 - e^(-(t - 0.1 - delay)/lag)) from then on, whatever share of a period the delay is.
TEST(CommandDelay, ActsWithinThePeriod) {
  for (const double lag : {0.0, 0.02})
    for (const double delay : {0.0, 0.0013, 0.005, 0.0089, 0.043}) {
      const FlightResult result = fly(one_motor(delay, lag));
      const std::vector<double>& w = result.log.find("x.w1")->values;
      const double c = std::sqrt(13840.8 * (10 + 0.1 * 490));
      for (std::size_t k = 0; k < w.size(); ++k) {
        const double t = static_cast<double>(k) * kPeriod;
        if (t > 0.25) break;
        const double since = t - 0.1 - delay;
        double expected = 0;
        if (lag > 0 && since > 0) expected = c * (1 - std::exp(-since / lag));
        // A row is written before its command: without lag it shows what turned until then.
        if (lag == 0 && since > 1e-6) expected = c;
        EXPECT_NEAR(w[k], expected, 2e-4 * c) << "lag " << lag << " delay " << delay << " t " << t;
      }
    }
}

// A delay of nothing at all is no other flight, and a tiny one hardly another.
TEST(CommandDelay, VanishesWithItsSize) {
  FlightSetup setup = one_motor(0, 0.02);
  setup.mission = load_mission("hover");
  setup.mission.start.in_air = true;  // contact with the ground is too stiff for small differences
  setup.mission.start.position = {0, 0, -1.1};
  setup.estimator = EstimatorKind::truth;
  setup.real_sensors = false;
  setup.duration = 3;
  setup.step = kPeriod;
  const FlightResult none = fly(setup);
  setup.vehicle.motor.delay = 1e-7;
  const FlightResult tiny = fly(setup);
  EXPECT_LT((none.final_state - tiny.final_state).norm(), 1e-4);
  EXPECT_GT((none.final_state - tiny.final_state).norm(), 0);
}

TEST(CommandDelay, JittersEvenlyAndKeepsTheOrder) {
  using internal::CommandDelay;
  const RandomSource<1> source{7, {3}};
  CommandDelay<1> line(0.002, 0.004, 64);
  EXPECT_TRUE(line.active());
  EXPECT_FALSE((CommandDelay<1>(0, 0, 64).active()));
  const int count = 20000;
  double sum = 0, square = 0, min = 1, max = 0;
  for (int k = 0; k < count; ++k) {  // each alone on its way
    line.send(static_cast<std::uint64_t>(k), k * 1.0, RotorSpeeds<Pack<1>>::Constant(1, k), source);
    const double late = line.next() - k;
    EXPECT_EQ(lane(line.take()(0), 0), k);
    sum += late;
    square += late * late;
    min = std::min(min, late);
    max = std::max(max, late);
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 0.004, 4 * 0.004 / std::sqrt(12.0 * count));
  EXPECT_NEAR(square / count - mean * mean, 0.004 * 0.004 / 12, 2e-7);
  EXPECT_GE(min, 0.002);
  EXPECT_LE(max, 0.006 + 1e-9);
  double before = 0;
  for (int k = 0; k < 100; ++k)  // many at once: none overtakes
    line.send(static_cast<std::uint64_t>(k), 0.0005 * k, RotorSpeeds<Pack<1>>::Constant(1, k),
              source);
  for (int k = 0; k < 100; ++k) {
    EXPECT_GE(line.next(), before);
    before = line.next();
    EXPECT_EQ(lane(line.take()(0), 0), k);
  }
  EXPECT_TRUE(std::isinf(line.next()));
}

TEST(CommandDelay, FliesAloneAsTogether) {
  for (const double jitter : {0.0, 0.003})
    for (const double lag : {0.0, 0.03}) {
      std::vector<FlightSetup> all;
      for (std::uint32_t i = 0; i < 5; ++i) {
        FlightSetup setup = one_motor(0.0032, lag);
        setup.vehicle.motor.delay_jitter = jitter;
        setup.mission = load_mission("hover");
        setup.duration = 2;
        setup.step = kPeriod;
        setup.flight = i;
        setup.flown = setup.vehicle;
        setup.flown->mass *= 1 + 0.01 * i;
        all.push_back(setup);
      }
      const std::vector<FlightResult> together = fly_all(all, 1);
      for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_STREQ(first_difference(together[i], fly(all[i])), "") << jitter << " " << lag;
    }
}

TEST(CommandDelay, IsReadAndRefused) {
  const Vehicle vehicle = parse_vehicle(
      vehicle_text("", "", "command_delay_s = 0.004\ncommand_jitter_s = 0.001"), "x.toml");
  EXPECT_EQ(vehicle.motor.delay, 0.004);
  EXPECT_EQ(vehicle.motor.delay_jitter, 0.001);
  const auto refusal = [](const std::string& motor, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_vehicle(vehicle_text("", "", motor), "x.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal("command_delay_s = -1",
          "command_delay_s in [motor] is -1, expected 0 or more and 10 or less");
  refusal("command_delay_s = nan", "command_delay_s in [motor] is");
  refusal("command_delay_s = \"late\"", "command_delay_s in [motor] is");
  refusal("command_jitter_s = 11",
          "command_jitter_s in [motor] is 11, expected 0 or more and 10 or less");
  EXPECT_THAT(
      [] { (void)fly(one_motor(0.201, 0)); },
      ThrowsMessage<InvalidInput>(StrEq("flight: the command delay is 0.201 s and its jitter 0 s, "
                                        "expected a sum of 0 to 40 control periods of 0.005 s")));
  EXPECT_NO_THROW(validate(one_motor(0.2, 0)));
}

}  // namespace
}  // namespace quadtune
