// SPDX-License-Identifier: Apache-2.0
/// One library call gives the same flight as the program.
#include "quadtune/workbench/flight/fly.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "run_program.hpp"
#include "same_bits.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::run_program;
using testing::same_bits;

FlightOptions short_hover(const std::string& controller) {
  FlightOptions options;
  options.controller = controller;
  options.duration = 14;  // the climb, and the window of the mission
  options.seed = 7;
  return options;
}

TEST(Fly, IsThePlannedFlight) {
  const Vehicle vehicle = load_vehicle("mambo");
  const FlownFlight flown = fly(vehicle, short_hover("pid"));
  const FlightResult again = fly(flown.plan.setup);
  for (std::size_t m = 0; m < kMetrics; ++m)
    EXPECT_TRUE(same_bits(flown.result.metrics[static_cast<Metric>(m)],
                          again.metrics[static_cast<Metric>(m)]));
  EXPECT_EQ(flown.result.final_state, again.final_state);
  EXPECT_EQ(flown.plan.estimator, "general");
  EXPECT_EQ(flown.plan.sensors, "real");
  EXPECT_TRUE(flown.plan.margins);
  EXPECT_GT(flown.wall_s, 0);
}

TEST(Fly, HasTheMetricsOfTheProgram) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const std::string vehicle : {"mambo", "uquad"})
    for (const std::string controller : {"pid", "lqr"}) {
      const FlownFlight flown = fly(load_vehicle(vehicle), short_hover(controller));
      const auto program = run_program({"fly", vehicle, "--controller", controller, "--duration",
                                        "14", "--seed", "7", "--json"});
      EXPECT_EQ(program.status, flown.passed ? 0 : 1) << program.err;
      const Json told = Json::parse(program.out);
      for (std::size_t m = 0; m < kMetrics; ++m) {
        const auto metric = static_cast<Metric>(m);
        const std::string& unit = unit_of(metric);
        const Json& value = told["metrics"][name_of(metric) + (unit == "1" ? "" : "_" + unit)];
        if (value.is_null())
          EXPECT_FALSE(std::isfinite(flown.result.metrics[metric]));
        else
          EXPECT_TRUE(same_bits(value.get<double>(), flown.result.metrics[metric]))
              << vehicle << " " << controller << " " << name_of(metric);
      }
      EXPECT_EQ(told["law"], flown.plan.law);
      EXPECT_EQ(told["reasons"], Json(reasons(flown)));
    }
}

TEST(Fly, SeedsAreFlightsOfTheirOwn) {
  FlightOptions options = short_hover("pid");
  options.vehicle = "mambo";
  const std::vector<FlownFlight> flights = fly_seeds(plan_flight(options, "test"), 3);
  ASSERT_EQ(flights.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    options.seed = 7 + i;
    EXPECT_EQ(flights[i].result.final_state,
              fly(load_vehicle("mambo"), options).result.final_state);
  }
  std::vector<FlownFlight> failed = flights;
  failed[1].passed = false;
  const FlownFlight worst = worst_of(failed);
  EXPECT_EQ(worst.plan.setup.seed, 8U);
  ASSERT_EQ(worst.seeds.size(), 3U);
  EXPECT_FALSE(worst.seeds[1].passed);
  EXPECT_EQ(worst_of(flights).plan.setup.seed, 7U);
  EXPECT_THROW((void)fly_seeds(plan_flight(options, "test"), 0), OptionError);
}

TEST(Fly, SaysWhyAFlightFailed) {
  const Vehicle vehicle = load_vehicle("mambo");
  FlightOptions options = short_hover("pid");
  options.sensors = "ideal";
  options.mission = "step-north";
  const FlownFlight good = fly(vehicle, options);
  ASSERT_TRUE(good.passed);
  EXPECT_THAT(reasons(good), IsEmpty());
  PlannedFlight plan = good.plan;
  plan.setup.mission.limits = {{Metric::tilt_max, 0}};
  const FlownFlight bad = fly_planned(plan);
  EXPECT_FALSE(bad.passed);
  EXPECT_THAT(reasons(bad), ElementsAre(HasSubstr("maximum tilt is ")));
  EXPECT_THAT(reasons(bad).front(), HasSubstr("expected at most 0 rad"));
}

TEST(Fly, EndsWhenItIsAsked) {
  EXPECT_THROW((void)fly(load_vehicle("mambo"), {}, [] { return true; }), Interrupted);
}

TEST(Fly, RefusesAMissionThatThereIsNot) {
  FlightOptions options;
  options.mission = "hoover";
  EXPECT_THROW((void)fly(load_vehicle("mambo"), options), InvalidInput);
}

}  // namespace
}  // namespace quadtune
