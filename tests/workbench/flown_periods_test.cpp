// SPDX-License-Identifier: Apache-2.0
/// One law at several control periods on the flown plant.
#include "quadtune/workbench/flown/flown_periods.hpp"

#include <gmock/gmock.h>

#include "quadtune/errors.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;

TEST(FlownPeriods, IsTheFlownLoopOfEachPeriod) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  CascadeController law{as_cascade(flown_gains(vehicle), 0.005)};
  const std::vector<FlownPeriod> all = flown_at_periods(vehicle, law, {0.0025, 0.005, 0.01});
  ASSERT_EQ(all.size(), 3U);
  for (const FlownPeriod& at : all) {
    ASSERT_TRUE(at.loop) << at.why;
    CascadeController alone = law;
    alone.gains.dt = at.dt;
    const FlownLoop loop = flown_loop(
        plan_flight(FlightOptions{}, vehicle, load_mission("hover"), ChosenLaw{alone, "test"}));
    EXPECT_EQ(at.loop->dt, at.dt);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(at.loop->margins.loops[i].Ms, loop.margins.loops[i].Ms);
  }
  // The hold of a longer period is a longer delay: the tilt loops have less phase.
  EXPECT_GT(all[0].loop->margins.loops[1].phase_margin, all[2].loop->margins.loops[1].phase_margin);
}

TEST(FlownPeriods, SaysWhyAPeriodHasNoPlant) {
  const Vehicle vehicle = load_vehicle("uquad");
  const StateFeedbackController law = feedback_controller(standard_gains(vehicle, "test"), 0.01);
  const std::vector<FlownPeriod> all = flown_at_periods(vehicle, law, {0.0025, 0.01});
  EXPECT_FALSE(all[0].loop);
  EXPECT_THAT(all[0].why,
              HasSubstr("the GPS has a delay of 0.2 s, expected at most 40 control periods"));
  EXPECT_TRUE(all[1].loop) << all[1].why;
}

TEST(FlownPeriodsBadInput, AMemoryBelongsToOnePeriod) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  FlightOptions options;
  options.controller = kStateFeedback;
  const ChosenLaw law = choose_law(options, vehicle, "test");
  EXPECT_THAT(
      [&] { (void)flown_at_periods(vehicle, law.controller, {0.005}); },
      ::testing::ThrowsMessage<InvalidInput>(HasSubstr("stores past commands at its own period")));
}

}  // namespace
}  // namespace quadtune
