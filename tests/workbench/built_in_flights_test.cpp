// SPDX-License-Identifier: Apache-2.0
// Built-in vehicles, and vehicles from files, fly the built-in missions with their own sensors and
// the default designs.
#include <gmock/gmock.h>

#include <cctype>
#include <string>
#include <vector>

#include "quadtune/workbench/flight/fly.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

constexpr std::uint32_t kSeeds = 5;

struct Flights {
  std::string vehicle;
  std::string controller;
};

const std::vector<std::string>& all_missions() {
  static const std::vector<std::string> missions = {
      "hover",       "take-off-and-land", "step-north", "step-east",
      "step-height", "step-yaw",          "waypoints",  "line",
      "circle",      "lemniscate",        "keys"};
  return missions;
}

class BuiltInFlights : public ::testing::TestWithParam<Flights> {};

TEST_P(BuiltInFlights, PassWithRealSensors) {
  if (testing::kSanitized) GTEST_SKIP() << "thousands of seconds of flight";
  const Flights& flights = GetParam();
  const Vehicle vehicle = load_vehicle(flights.vehicle.starts_with("vehicles/")
                                           ? testing::source_folder() + "/" + flights.vehicle
                                           : flights.vehicle);
  FlightOptions options;
  options.controller = flights.controller;
  const ChosenLaw law = choose_law(options, vehicle, "test");
  for (const std::string& mission : all_missions()) {
    const PlannedFlight plan = plan_flight(options, vehicle, load_mission(mission), law);
    for (const FlownFlight& flight : fly_seeds(plan, kSeeds))
      EXPECT_TRUE(flight.passed) << mission << ", seed " << flight.plan.setup.seed << ": "
                                 << ::testing::PrintToString(reasons(flight));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Vehicles, BuiltInFlights,
    ::testing::Values(Flights{"mambo", "cascaded-pid"}, Flights{"mambo", "state-feedback"},
                      Flights{"rolling-spider", "cascaded-pid"},
                      Flights{"rolling-spider", "state-feedback"},
                      Flights{"crazyflie", "cascaded-pid"}, Flights{"crazyflie", "state-feedback"},
                      Flights{"uquad", "cascaded-pid"}, Flights{"uquad", "state-feedback"},
                      Flights{"vehicles/racer-250.toml", "cascaded-pid"},
                      Flights{"vehicles/racer-250.toml", "state-feedback"},
                      Flights{"vehicles/quad-450.toml", "cascaded-pid"},
                      Flights{"vehicles/quad-450.toml", "state-feedback"},
                      Flights{"vehicles/hexa-550.toml", "cascaded-pid"},
                      Flights{"vehicles/hexa-550.toml", "state-feedback"}),
    [](const auto& tested) {
      std::string name = tested.param.vehicle + "_" + tested.param.controller;
      for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      return name;
    });

}  // namespace
}  // namespace quadtune
