// SPDX-License-Identifier: Apache-2.0
// Default designs of the built-in vehicles at other heights, and on vehicles that differ from the
// design in one property each.
#include <gmock/gmock.h>

#include <functional>
#include <string>
#include <vector>

#include "quadtune/workbench/flight/fly.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

struct Variation {
  std::string name;
  std::function<void(Vehicle&)> change;
};

void scale_lag(Vehicle& vehicle, double factor) {
  for (Rotor& rotor : vehicle.rotors) {
    rotor.lag *= factor;
    rotor.lag_down *= factor;
  }
}

const std::vector<Variation>& variations() {
  static const std::vector<Variation> all = {
      {"20 % heavier",
       [](Vehicle& v) {
         v.mass *= 1.2;
         v.inertia *= 1.2;
       }},
      {"20 % lighter",
       [](Vehicle& v) {
         v.mass *= 0.8;
         v.inertia *= 0.8;
       }},
      {"mass alone 20 % more", [](Vehicle& v) { v.mass *= 1.2; }},
      {"lag 40 % longer", [](Vehicle& v) { scale_lag(v, 1.4); }},
      {"lag 40 % shorter", [](Vehicle& v) { scale_lag(v, 0.6); }},
      {"gyroscope 5 ms later", [](Vehicle& v) { v.sensors.gyroscope->delay += 0.005; }},
      {"one motor 10 % weaker",
       [](Vehicle& v) {
         v.rotors[0].thrust_a2 *= 0.9;
         v.rotors[0].thrust_a1 *= 0.9;
       }},
  };
  return all;
}

struct FlightsOfVariants {
  std::string vehicle, controller;
};

class VariedFlights : public ::testing::TestWithParam<FlightsOfVariants> {
 protected:
  void SetUp() override {
    if (testing::kSanitized) GTEST_SKIP() << "thousands of seconds of flight";
  }
};

void expect_all_pass(const PlannedFlight& plan, const std::string& what) {
  for (const FlownFlight& flight : fly_seeds(plan, 5))
    EXPECT_TRUE(flight.passed) << what << ", seed " << flight.plan.setup.seed << ": "
                               << ::testing::PrintToString(reasons(flight));
}

TEST_P(VariedFlights, PassAtOtherHeights) {
  const Vehicle vehicle = load_vehicle(GetParam().vehicle);
  FlightOptions options;
  options.controller = GetParam().controller;
  const ChosenLaw law = choose_law(options, vehicle, "test");
  for (const double height : {0.5, 1.0, 2.0, 3.0, 4.0}) {
    Mission mission = load_mission("hover");
    std::get<Hover>(mission.kind).position.z() = -height;
    expect_all_pass(plan_flight(options, vehicle, mission, law),
                    std::to_string(height) + " m of height");
  }
}

TEST_P(VariedFlights, PassWithAnotherVehicle) {
  const Vehicle vehicle = load_vehicle(GetParam().vehicle);
  FlightOptions options;
  options.controller = GetParam().controller;
  const ChosenLaw law = choose_law(options, vehicle, "test");
  for (const char* mission : {"hover", "step-north", "take-off-and-land"}) {
    PlannedFlight plan = plan_flight(options, vehicle, load_mission(mission), law);
    for (const Variation& variation : variations()) {
      Vehicle flown = plan.setup.vehicle;
      variation.change(flown);
      plan.setup.flown = flown;
      expect_all_pass(plan, std::string(mission) + ", " + variation.name);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Vehicles, VariedFlights,
                         ::testing::Values(FlightsOfVariants{"mambo", "cascaded-pid"},
                                           FlightsOfVariants{"mambo", "state-feedback"},
                                           FlightsOfVariants{"rolling-spider", "cascaded-pid"},
                                           FlightsOfVariants{"rolling-spider", "state-feedback"},
                                           FlightsOfVariants{"crazyflie", "cascaded-pid"},
                                           FlightsOfVariants{"crazyflie", "state-feedback"},
                                           FlightsOfVariants{"uquad", "cascaded-pid"},
                                           FlightsOfVariants{"uquad", "state-feedback"}),
                         [](const auto& tested) {
                           std::string name = tested.param.vehicle + "_" + tested.param.controller;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

}  // namespace
}  // namespace quadtune
