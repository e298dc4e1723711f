// SPDX-License-Identifier: Apache-2.0
/// Each cause of a failed flight, provoked on purpose.
#include "quadtune/workbench/flight/diagnosis.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;

PlannedFlight planned(const std::string& vehicle, const std::string& mission = "hover",
                      double duration = 20) {
  FlightOptions options;
  options.vehicle = vehicle;
  options.mission = mission;
  options.duration = duration;
  return plan_flight(options, "test");
}

Diagnosis diagnosis_of(const PlannedFlight& plan) { return diagnose(plan, fly_planned(plan)); }

TEST(Diagnosis, IsNoneOfAFlightThatPassed) {
  const Diagnosis diagnosis = diagnosis_of(planned("mambo"));
  EXPECT_EQ(diagnosis.cause, FlightCause::none);
  EXPECT_EQ(diagnosis.why, "");
}

// A rate loop with the wrong sign is unstable with true states, too.
TEST(Diagnosis, FindsAnUnstableLoop) {
  PlannedFlight plan = planned("mambo");
  for (PidLoop& loop : std::get<CascadeController>(plan.setup.controller).gains.loops)
    if (loop.name == "roll") loop.Kd = -loop.Kd;
  const Diagnosis diagnosis = diagnosis_of(plan);
  EXPECT_EQ(diagnosis.cause, FlightCause::unstable_loop) << diagnosis.why;
  EXPECT_GT(diagnosis.evidence.largest_pole, 1);
  EXPECT_THAT(diagnosis.why, HasSubstr("the flown loop is unstable"));
  EXPECT_THAT(diagnosis.next, HasSubstr("quadtune margins mambo --gains gains.json"));
}

// The flow compensated with a delayed gyroscope: stable with true states only.
TEST(Diagnosis, FindsALoopThatItsEstimatorDestabilizes) {
  FlightOptions options;
  options.vehicle = "mambo";
  options.controller = "state-feedback";
  options.estimator = "mambo";
  options.mission = "step-height";
  PlannedFlight plan = plan_flight(options, "test");
  plan.setup.mambo_estimator.aligned_periods = 0;
  const Diagnosis diagnosis = diagnosis_of(plan);
  EXPECT_EQ(diagnosis.cause, FlightCause::estimator_loop) << diagnosis.why;
  EXPECT_TRUE(diagnosis.evidence.passes_with_true_states);
  EXPECT_THAT(diagnosis.why, HasSubstr("stable with true states"));
}

// A position loop with a hundredth of its gain does not reach its set point.
TEST(Diagnosis, FindsALawThatIsTooSlow) {
  PlannedFlight plan = planned("mambo", "step-north", 10);
  for (PidLoop& loop : std::get<CascadeController>(plan.setup.controller).gains.loops)
    if (loop.name == "x" || loop.name == "y") {
      loop.Kp *= 0.02;
      loop.Ki = 0;
    }
  const Diagnosis diagnosis = diagnosis_of(plan);
  EXPECT_EQ(diagnosis.cause, FlightCause::law) << diagnosis.why;
  EXPECT_THAT(diagnosis.why, HasSubstr("the law alone fails"));
}

// A motor that stops, and a load too heavy for the mission's limits: not a failure of the law.
TEST(Diagnosis, FindsAnEvent) {
  PlannedFlight plan = planned("mambo", "hover", 30);
  plan.setup.mission.events = {{15, MotorFault{2, 0}}};
  const Diagnosis stopped = diagnosis_of(plan);
  EXPECT_EQ(stopped.cause, FlightCause::event) << stopped.why;
  EXPECT_THAT(
      stopped.why,
      HasSubstr(
          "motor 2 stops at 15 s: with true states the law passes without it and fails with it: "));
  EXPECT_THAT(stopped.next, HasSubstr("thrust_share above 0"));
  plan.setup.mission.events = {{15, LoadChange{0.3 * plan.setup.vehicle.mass}}};
  const Diagnosis loaded = diagnosis_of(plan);
  EXPECT_EQ(loaded.cause, FlightCause::event) << loaded.why;
  EXPECT_THAT(loaded.why, HasSubstr("is picked up at 15 s"));
  EXPECT_THAT(loaded.next, HasSubstr("quadtune tune pid mambo --mission FILE"));
  // With two events: the one without which the law passes; a load that the motors cannot lift.
  plan.setup.mission.events.push_back({20, LoadChange{-0.001}});
  EXPECT_THAT(diagnosis_of(plan).why, HasSubstr("is picked up at 15 s: with true states"));
  plan.setup.mission.events = {{15, LoadChange{0.1}}};
  const Diagnosis heavy = diagnosis_of(plan);
  EXPECT_EQ(heavy.cause, FlightCause::event);
  EXPECT_THAT(heavy.why, HasSubstr("heavier than the maximum thrust of the law"));
  EXPECT_THAT(heavy.next, HasSubstr("more thrust, or a copy of the mission's file"));
}

// A tilt limit slightly below the tilt that the law commands.
TEST(Diagnosis, FindsLimitsThatAreTight) {
  PlannedFlight plan = planned("mambo", "step-north", 15);
  PlannedFlight truth = plan;
  truth.setup.estimator = EstimatorKind::truth;
  const double tilt = fly_planned(truth).result.metrics[Metric::tilt_max];
  plan.setup.mission.limits = {{Metric::tilt_max, 0.9 * tilt}};
  const Diagnosis diagnosis = diagnosis_of(plan);
  EXPECT_EQ(diagnosis.cause, FlightCause::mission_limits) << diagnosis.why;
  EXPECT_THAT(diagnosis.next, HasSubstr("wider [limits]"));
}

/// Limits that these sensors do not allow, without widening.
PlannedFlight with_limit(PlannedFlight plan, Metric metric, double max) {
  plan.setup.mission.limits = {{metric, max}};
  plan.widened.clear();
  return plan;
}

// The Mambo's flow has no noise in its file: errors of its position are those of the filter.
TEST(Diagnosis, FindsAnEstimatorWorseThanItsSensors) {
  const Diagnosis diagnosis =
      diagnosis_of(with_limit(planned("mambo", "hover", 60), Metric::tracking_rms, 1e-3));
  EXPECT_EQ(diagnosis.cause, FlightCause::estimator) << diagnosis.why;
  EXPECT_GT(diagnosis.evidence.estimate_rms, diagnosis.evidence.estimate_limit);
  EXPECT_THAT(diagnosis.why, HasSubstr("the optimal filter with these sensors"));
}

TEST(Diagnosis, FindsDriftOfDeadReckoning) {
  Vehicle vehicle = load_vehicle("mambo");
  vehicle.sensors.flow->faults.noise.setConstant(0.3);
  FlightOptions options;
  options.duration = 60;
  const PlannedFlight noisy = plan_flight(options, vehicle, "test");
  const Diagnosis drift = diagnosis_of(with_limit(noisy, Metric::tracking_rms, 0.01));
  EXPECT_EQ(drift.cause, FlightCause::drift) << drift.why;
  EXPECT_THAT(drift.next, HasSubstr("[sensors.gps]"));
}

TEST(Diagnosis, FindsTheSensorsThemselves) {
  const Diagnosis diagnosis =
      diagnosis_of(with_limit(planned("uquad", "hover", 60), Metric::tracking_rms, 0.05));
  EXPECT_EQ(diagnosis.cause, FlightCause::sensors) << diagnosis.why;
  EXPECT_NEAR(diagnosis.evidence.bound_rms, 0.32, 0.02);
  EXPECT_THAT(diagnosis.why, HasSubstr("the optimal filter with these sensors"));
}

// A tilt that errors of the position do not explain.
TEST(Diagnosis, FindsALawThatFollowsItsNoise) {
  PlannedFlight plan = planned("uquad", "hover", 60);
  PlannedFlight truth = plan;
  truth.setup.estimator = EstimatorKind::truth;
  const double quiet = fly_planned(truth).result.metrics[Metric::tilt_max];
  const Diagnosis diagnosis =
      diagnosis_of(with_limit(plan, Metric::tilt_max, std::max(1.2 * quiet, 0.02)));
  EXPECT_EQ(diagnosis.cause, FlightCause::noise) << diagnosis.why;
}

}  // namespace
}  // namespace quadtune
