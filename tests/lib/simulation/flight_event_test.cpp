// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/flight_event.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "same_flight.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using testing::first_difference;
using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

std::string mission_text(const std::string& events) {
  return "name = \"upset\"\nduration_s = 4\n[start]\nat = \"air\"\nheight_m = 2\n"
         "[hover]\nheight_m = 2\n" +
         events;
}

FlightSetup flight(const std::string& events, double lag = 0) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = lag;
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.estimator = EstimatorKind::truth;
  setup.mission = parse_mission(mission_text(events), "upset.toml");
  setup.log = true;
  return setup;
}

const std::vector<double>& log_column(const FlightResult& result, const char* name) {
  return result.log.find(name)->values;
}

// The events of a flight that come from its mission's list.
std::vector<LogEvent> upsets(const FlightResult& result) {
  std::vector<LogEvent> all;
  for (const LogEvent& event : result.events)
    if (event.name == "event") all.push_back(event);
  return all;
}

// The thrust is still m g when the mass becomes m + Δ: v' = g Δ/(m + Δ) downward.
TEST(FlightEvent, LoadsChangeTheMassAtTheirTime) {
  for (const double load : {-0.01, 0.02}) {
    const FlightResult result =
        fly(flight("[[event]]\nat_s = 1\nload_kg = " + std::to_string(load) + "\n"));
    ASSERT_EQ(result.end, FlightEnd::completed);
    const std::vector<double>& w = log_column(result, "x.w");
    EXPECT_NEAR(w[200], 0, 1e-9);
    EXPECT_NEAR((w[201] - w[200]) / 0.005, 9.81 * load / (0.063 + load), 1e-3);
    const std::vector<LogEvent> events = upsets(result);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].time, 1);
    EXPECT_EQ(events[0].detail,
              load < 0 ? "a load of 0.01 kg is dropped" : "a load of 0.02 kg is picked up");
    EXPECT_EQ(result.log.events.size(), result.events.size());
  }
}

// A rotor that keeps the share s of its thrust and drag lifts less: -(1 - s) T at its hub.
TEST(FlightEvent, MotorsKeepAShareOfTheirThrust) {
  const FlightResult result = fly(flight("[[event]]\nat_s = 1\nmotor = 2\nthrust_share = 0.8\n"));
  const double lost = 0.2 * 0.063 * 9.81 / 4;  // of rotor 2, at (0.0441, 0.0441)
  const double arm = 0.04412346314604056;
  const std::vector<double>&p = log_column(result, "x.p"), &q = log_column(result, "x.q"),
        &w = log_column(result, "x.w");
  // T right of the centre rolls left: less of it rolls right; ahead pitches up: less pitches down.
  EXPECT_NEAR((p[201] - p[200]) / 0.005, arm * lost / 5.82857e-5, 0.02 * arm * lost / 5.82857e-5);
  EXPECT_NEAR((q[201] - q[200]) / 0.005, -arm * lost / 7.16914e-5, 0.02 * arm * lost / 7.16914e-5);
  EXPECT_NEAR((w[201] - w[200]) / 0.005, lost / 0.063, 0.02 * lost / 0.063);
  EXPECT_EQ(upsets(result).at(0).detail, "motor 2 keeps 0.8 of its thrust");
}

// A failed motor receives no commands and slows down with its lag.
TEST(FlightEvent, MotorsStopForGood) {
  for (const double lag : {0.0, 0.03}) {
    const FlightResult result =
        fly(flight("[[event]]\nat_s = 1\nmotor = 3\nthrust_share = 0\n", lag));
    const std::vector<double>&w = log_column(result, "x.w3"),
          &told = log_column(result, "command.w3");
    ASSERT_GT(w[200], 100);
    EXPECT_NEAR(w[201], lag > 0 ? w[200] * std::exp(-0.005 / 0.03) : 0, 1e-3 * w[200]);
    for (std::size_t k = 200; k < told.size(); ++k) EXPECT_EQ(told[k], 0);
    EXPECT_EQ(result.end, FlightEnd::safety_exit);  // three rotors do not hold it
    EXPECT_EQ(upsets(result).at(0).detail, "motor 3 stops");
  }
}

TEST(FlightEvent, FliesAloneAsTogether) {
  std::vector<FlightSetup> all;
  for (std::uint32_t i = 0; i < 5; ++i) {
    FlightSetup setup = flight(
        "[[event]]\nat_s = 1\nload_kg = 0.01\n[[event]]\nat_s = 1.5\nmotor = 1\nthrust_share = "
        "0.95\n[[event]]\nat_s = 3\nmotor = 1\nthrust_share = 0\n");
    setup.flight = i;
    setup.flown = setup.vehicle;
    setup.flown->mass *= 1 + 0.02 * i;
    all.push_back(setup);
  }
  const std::vector<FlightResult> together = fly_all(all, 1);
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_STREQ(first_difference(together[i], fly(all[i])), "") << i;
}

TEST(FlightEvent, IsReadInOrder) {
  const Mission mission =
      parse_mission(mission_text("[[event]]\nat_s = 1\nmotor = 2\nthrust_share = 0.7\n"
                                 "[[event]]\nat_s = 3\nload_kg = -0.1\n"),
                    "x.toml");
  EXPECT_THAT(mission.events,
              ElementsAre(FlightEvent{1, MotorFault{2, 0.7}}, FlightEvent{3, LoadChange{-0.1}}));
}

TEST(FlightEvent, RefusesWhatCannotHappen) {
  const auto refusal = [](const std::string& events, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_mission(mission_text("[[event]]\n" + events), "x.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal("at_s = 1\n", "[[event]] 1 has neither motor nor load_kg, expected one of them");
  refusal("at_s = 1\nmotor = 1\nload_kg = 1\n", "[[event]] 1 has both motor and load_kg");
  refusal("at_s = 1\nmotor = 0\nthrust_share = 0\n", "motor in [[event]] 1 is 0, expected");
  refusal("at_s = 1\nmotor = 1\n", "thrust_share");
  refusal("at_s = 1\nmotor = 1\nthrust_share = 1.2\n",
          "thrust_share in [[event]] 1 is 1.2, expected 0 or more and 1 or less");
  refusal("at_s = 1\nload_kg = 1\nthrust_share = 1\n",
          "[[event]] 1 has thrust_share without motor, expected the motor");
  refusal("at_s = 1\nload_kg = 0\n",
          "event 1: its load is 0 kg, expected a nonzero number: positive");
  refusal("at_s = 5\nload_kg = 1\n",
          "event 1: its time is 5 s, expected 0 to the mission's duration, 4 s");
  refusal("at_s = 2\nload_kg = 1\n[[event]]\nat_s = 1\nload_kg = 1\n",
          "event 2: its time is 1 s, expected at least that of the event before, 2 s");
  EXPECT_THAT(
      [] {
        (void)parse_mission(
            "name = \"c\"\nduration_s = 4\ncarried = true\n[line]\nnorth_m = 0\n"
            "[[event]]\nat_s = 1\nload_kg = 1\n",
            "x.toml");
      },
      ThrowsMessage<InvalidInput>(
          HasSubstr("[event] is not allowed in a mission in which the vehicle is carried")));
  const auto unfit = [](const std::string& events, const std::string& message) {
    EXPECT_THAT([&] { validate(flight(events)); }, ThrowsMessage<InvalidInput>(StrEq(message)));
  };
  unfit("[[event]]\nat_s = 1\nmotor = 5\nthrust_share = 0\n",
        "mission 'upset': event 1: its motor is 5, expected 1 to 4, the motors of 'mambo'");
  unfit("[[event]]\nat_s = 1\nload_kg = 0.01\n[[event]]\nat_s = 2\nload_kg = -0.08\n",
        "mission 'upset': event 2: 'mambo' weighs -0.007 kg after dropping 0.08 kg, expected more "
        "than 0");
}

}  // namespace
}  // namespace quadtune
