// SPDX-License-Identifier: Apache-2.0
/// Only limits that the sensors do not allow are widened.
#include "quadtune/workbench/flight/widened_limits.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {
namespace {

using ::testing::IsEmpty;

MissionBound bound_of(double rms) {
  MissionBound bound;
  bound.tracking = {rms, 1.4 * rms, 3.5 * rms, 30};
  bound.height = {0.1 * rms, 0.12 * rms, 0.4 * rms, 60};
  bound.heading = {0.01, 0.02, 0.05, 3};
  bound.estimate = bound.tracking;
  bound.overshoot = {rms / 2, 0.7 * rms, 3.5 * rms / 2, 30};
  bound.horizontal_end = 2 * rms;
  bound.final_rarely = 6 * rms;
  bound.drift_rarely = 5 * rms;
  return bound;
}

double limit_of(const Mission& mission, Metric metric) {
  for (const Limit& limit : mission.limits)
    if (limit.metric == metric) return limit.max;
  return -1;
}

TEST(WidenedLimits, FollowTheBound) {
  Mission mission;
  mission.settling = {0.1, 0.2, 5};
  mission.limits = {
      {Metric::settling_time, 10},   {Metric::overshoot, 0.1},     {Metric::tracking_rms, 0.05},
      {Metric::tracking_max, 0.15},  {Metric::height_rms, 0.05},   {Metric::height_max, 0.2},
      {Metric::yaw_rms, 0.001},      {Metric::yaw_max, 0.1},       {Metric::tilt_max, 0.01},
      {Metric::speed_max, 0.1},      {Metric::saturation_time, 0}, {Metric::energy, 1},
      {Metric::estimate_rms, 0.01},  {Metric::estimate_max, 0.01}, {Metric::position_drift, 0.1},
      {Metric::final_distance, 0.1}, {Metric::touchdown_speed, 0}, {Metric::height_peak, 0.1}};
  const std::vector<WidenedLimit> widened = widen_limits(bound_of(0.32), mission);
  EXPECT_EQ(limit_of(mission, Metric::tracking_rms), 1.5 * 0.32);
  EXPECT_EQ(limit_of(mission, Metric::tracking_max), 1.5 * (3.5 * 0.32));
  EXPECT_EQ(limit_of(mission, Metric::height_rms), 0.05);  // the sensors are better
  EXPECT_EQ(limit_of(mission, Metric::height_max), 0.2);
  EXPECT_EQ(limit_of(mission, Metric::height_peak), 1.5 * (0.4 * 0.32));
  EXPECT_EQ(limit_of(mission, Metric::yaw_rms), 0.02);  // rarely exceeded with 1.5 times 0.01
  EXPECT_EQ(limit_of(mission, Metric::yaw_max), 0.1);
  EXPECT_EQ(limit_of(mission, Metric::overshoot), 1.5 * (3.5 * 0.32 / 2));  // a step of 2 m
  EXPECT_EQ(limit_of(mission, Metric::estimate_rms), 1.5 * 0.32);
  EXPECT_EQ(limit_of(mission, Metric::estimate_max), 1.5 * (3.5 * 0.32));
  EXPECT_EQ(limit_of(mission, Metric::position_drift), 1.5 * (5 * 0.32));
  EXPECT_EQ(limit_of(mission, Metric::final_distance), 1.5 * (6 * 0.32));
  EXPECT_EQ(mission.settling.band, 0.1);  // steps are detected with it
  EXPECT_EQ(mission.settling.settled_band, 1.5 * (3.5 * 0.32));
  EXPECT_EQ(mission.settling.settled_yaw_band, 0);
  for (const auto& [metric, max] :
       {std::pair(Metric::tilt_max, 0.01), std::pair(Metric::speed_max, 0.1),
        std::pair(Metric::saturation_time, 0.0), std::pair(Metric::energy, 1.0),
        std::pair(Metric::touchdown_speed, 0.0), std::pair(Metric::settling_time, 10.0)})
    EXPECT_EQ(limit_of(mission, metric), max) << name_of(metric);
  ASSERT_EQ(widened.size(), 10U);
  EXPECT_EQ(describe(widened[0]),
            "limit 0.1 widened to 0.84, because the sensors alone cause 0.16 rms");
  EXPECT_EQ(widened[1].what, "tracking_rms");
  EXPECT_EQ(describe(widened[1]),
            "limit 0.05 m widened to 0.48 m, because the sensors alone cause 0.32 m rms");
  EXPECT_EQ(widened.back().what, "settling_band");
}

TEST(WidenedLimits, StayWhereTheSensorsCanDoBetter) {
  Mission mission;
  mission.settling.yaw_band = 0.1;
  mission.limits = {{Metric::tracking_rms, 0.05}, {Metric::settling_time, 5}};
  const Mission before = mission;
  EXPECT_THAT(widen_limits(bound_of(0.001), mission), IsEmpty());
  EXPECT_EQ(mission, before);
}

/// A law with the accuracy of the sensors passes; one that adds its own error fails.
TEST(WidenedLimits, AreWhatAFlightIsJudgedBy) {
  FlightOptions options;
  options.vehicle = "uquad";
  const PlannedFlight plan = plan_flight(options, "test");
  const auto tracking =
      std::find_if(plan.widened.begin(), plan.widened.end(),
                   [](const WidenedLimit& w) { return w.what == "tracking_rms"; });
  ASSERT_NE(tracking, plan.widened.end());
  EXPECT_EQ(tracking->asked, 0.05);
  EXPECT_NEAR(tracking->judged, 0.50, 0.01);
  EXPECT_EQ(tracking->judged, kRmsOverBound * plan.bound->tracking.rms);
  FlownFlight flight;
  flight.plan = plan;
  MetricValues values;
  for (std::size_t i = 0; i < kMetrics; ++i) values.value[i] = 0;
  values[Metric::duration] = 100;
  values[Metric::tracking_rms] = 0.45;
  EXPECT_TRUE(judge(plan.setup.mission, values).ok);
  values[Metric::tracking_rms] = 0.55;
  flight.verdict = judge(plan.setup.mission, values);
  EXPECT_FALSE(flight.verdict.ok);
  ASSERT_EQ(reasons(flight).size(), 1U);
  EXPECT_THAT(reasons(flight)[0],
              ::testing::HasSubstr("because the sensors alone cause 0.333 m rms"));
}

}  // namespace
}  // namespace quadtune
