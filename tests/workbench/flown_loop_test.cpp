// SPDX-License-Identifier: Apache-2.0
/// The flown loop of a flight, and designs that it makes fail.
#include "quadtune/workbench/flown/flown_loop.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <string>

#include "plants/designed_mambo.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;

PlannedFlight plan_of_vehicle(const std::string& vehicle) {
  FlightOptions options;
  options.vehicle = vehicle;
  return plan_flight(options, "test");
}

FlownLoopOptions at_height(double height) {
  FlownLoopOptions at;
  at.height = height;
  return at;
}

FlownLoopOptions delayed_by(double delay) {
  FlownLoopOptions at;
  at.command_delay = delay;
  return at;
}

TEST(FlownLoop, OfADesignedCascadeHoldsAtEveryHeight) {
  const PlannedFlight plan = plan_of_vehicle("mambo");
  for (const double height : {0.5, 1.1, 2.0, 3.0, 4.0}) {
    const FlownLoop loop = flown_loop(plan, at_height(height));
    EXPECT_TRUE(loop.stable()) << height << ": " << describe(loop);
    EXPECT_GT(loop.decay(), 0);
    EXPECT_EQ(loop.period, 10U);
    ASSERT_EQ(loop.margins.loops.size(), 4U);
    for (const LoopMargins& margins : loop.margins.loops) EXPECT_TRUE(margins.stable);
  }
}

/// Without the alignment of flow and gyroscope, the same cascade crashes from 3 m, as flights
/// showed.
TEST(FlownLoop, KnowsWhyTheMamboFell) {
  FlightOptions options;
  options.estimator = "mambo";
  const PlannedFlight plan = plan_flight(options, load_vehicle("mambo"), load_mission("hover"),
                                         ChosenLaw{testing::designed_mambo_cascade(), "by loops"});
  PlannedFlight before = plan;
  before.setup.mambo_estimator.aligned_periods = 0;
  EXPECT_TRUE(flown_loop(before, at_height(2.0)).stable());
  const FlownLoop loop = flown_loop(before, at_height(4.0));
  EXPECT_TRUE(loop.grows()) << describe(loop);
  EXPECT_THAT(describe(loop), HasSubstr("deviations double in"));
  const std::string why = what_helps(before, loop);
  EXPECT_THAT(why, HasSubstr("true states"));
  EXPECT_THAT(why, HasSubstr("sensors without delay"));
}

TEST(FlownLoop, TellsDelayedCommandsFromPrompt) {
  const PlannedFlight plan = plan_of_vehicle("mambo");
  const FlownLoop prompt = flown_loop(plan);
  const FlownLoop late = flown_loop(plan, delayed_by(0.006));
  for (std::size_t i = 1; i < 3; ++i)
    EXPECT_LT(late.margins.loops[i].phase_margin, prompt.margins.loops[i].phase_margin);
  EXPECT_TRUE(flown_loop(plan, delayed_by(0.05)).grows());
}

/// An LQR without a model of 72 ms of lag hovers well with true states, because nothing disturbs
/// it, and is unstable.
TEST(Design, DoesNotPassWithAFlownLoopThatGrows) {
  Vehicle crazyflie = load_vehicle("crazyflie");
  for (Rotor& rotor : crazyflie.rotors) rotor.drag = rotor.inflow = 0;  // they damp it
  DesignRequirements requirements;
  requirements.lqr = usual_lqr(crazyflie);
  MissionRequest hover;
  hover.mission = "hover";
  hover.estimator = "truth";
  requirements.missions = {hover};
  const DesignOutcome outcome = design(crazyflie, requirements);
  ASSERT_EQ(outcome.flights.size(), 1U);
  const FlownFlight& flight = outcome.flights[0];
  EXPECT_TRUE(flight.verdict.ok);
  EXPECT_FALSE(flight.passed);
  ASSERT_TRUE(flight.loop);
  EXPECT_GT(std::abs(flight.loop->mode.z), 1.0001);
  ASSERT_FALSE(reasons(flight).empty());
  EXPECT_THAT(reasons(flight)[0],
              HasSubstr("the flown loop is unstable at 1.1 m, largest |z| 1.00"));
  EXPECT_THAT(reasons(flight)[0], HasSubstr("rotors without lag"));
}

TEST(FlownLoop, SaysWhatNoSensorTells) {
  const FlownLoop loop = flown_loop(plan_of_vehicle("mambo"));
  ASSERT_FALSE(flown_notes(loop).empty());
  bool told = false;
  for (const std::string& note : flown_notes(loop))
    told = told || note.find("do not observe px, py and yaw") != std::string::npos;
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace quadtune
