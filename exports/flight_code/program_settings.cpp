// SPDX-License-Identifier: Apache-2.0
#include "flight_code/program_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "flight_code/adapters.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/included_estimator.hpp"
#include "quadtune/simulation/designed_controller.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/simulation/uquad_flight.hpp"

namespace quadtune {

std::string included_estimator(const std::optional<StoredEstimator>& estimator,
                               const std::string& adapter) {
  if (!estimator || exports::adapter_estimates(adapter)) return "";
  if (estimator->general) return "general";
  return estimator->name == "mambo" || estimator->name == "uquad" ? estimator->name : "";
}

namespace exports {
namespace {

// From the ground to 1 m, then a simultaneous step in position, height and heading: errors are
// large, and the motors saturate.
constexpr char kRecordedMission[] = R"(name = "recorded"
description = "Up to 1 m, then a step aside and a turn at once"
duration_s = 5
[start]
at = "ground"
start_up_s = 0.2
[[references]]
at_s = 0
height_m = 1
[[references]]
at_s = 2.5
north_m = 1.5
east_m = -1
height_m = 2.5
yaw_rad = 2
)";

Controller controller_of(const ExportContent& content) {
  const std::string& law = content.flight_code.law;
  if (!law.empty()) require_flight_code_law(law, "flight code");
  if (law.empty() && content.gains && content.cascade)
    throw InvalidInput(
        "flight code",
        "the design has a cascaded PID and a state feedback, expected the law "
        "cascaded-pid or state-feedback to be selected, because only one of them flies");
  const bool by_cascade = law.empty() ? !content.gains : law == "cascaded-pid";
  if (by_cascade ? !content.cascade || content.cascade->gains.loops.empty() : !content.gains)
    throw InvalidInput("flight code",
                       law.empty()
                           ? std::string("the design has no law, expected a cascaded PID or "
                                         "a state feedback")
                           : fmt::format("the design has no law '{}', expected {}", law,
                                         by_cascade ? "state-feedback" : "cascaded-pid"));
  if (by_cascade) return cascade_controller(*content.cascade, content.cascade->gains);
  if (!(content.gains->dt > 0))
    throw InvalidInput("flight code",
                       "the gains are continuous, expected those of a sample period because a "
                       "program runs once per period");
  return feedback_controller(*content.gains, content.gains->dt);
}

}  // namespace

FlightSetup recorded_setup(const ExportContent& content) {
  FlightSetup setup;
  setup.vehicle = content.vehicle;
  setup.mission = parse_mission(kRecordedMission, "recorded mission");
  setup.controller = controller_of(content);
  constexpr double kMaxPeriods = 5000;  // one line each
  setup.duration = std::min(setup.mission.duration, kMaxPeriods * control_period(setup));
  setup.allocation = AllocationRule::prioritized;
  setup.estimator = EstimatorKind::truth;
  const std::string estimator = included_estimator(content.estimator, content.flight_code.adapter);
  if (!estimator.empty()) setup.estimator = estimator_kind(estimator, "flight code");
  if (estimator == "mambo" || estimator == "uquad") {
    if (!feed_estimator(setup.vehicle.sensors, estimator))
      throw InvalidInput(
          "flight code",
          fmt::format("the sensors of '{}' do not suffice for the estimator '{}'; expected "
                      "at least those that it requires",
                      setup.vehicle.name, estimator));
    // These estimators calibrate their sensors while the vehicle is stationary, here as long as in
    // the built-in missions.
    constexpr double kCalibration = 0.5;  // [s]
    setup.mission.start.start_up = kCalibration;
    calibrate_flow(setup);
    setup.uquad_filter = uquad_filter_for(setup.vehicle.sensors);
  }
  if (!estimator.empty()) take_numbers(*content.estimator, setup);
  validate(setup);
  return setup;
}

ProgramSettings program_settings(const FlightSetup& setup) {
  ProgramSettings settings;
  const Vehicle& vehicle = setup.vehicle;
  settings.dt = control_period(setup);
  if (setup.estimator == EstimatorKind::general) settings.general = general_filter_settings(setup);
  if (setup.estimator == EstimatorKind::mambo) {
    settings.mambo = setup.mambo_estimator;
    settings.mambo->dt = settings.dt;
    settings.mambo->gravity = vehicle.gravity;
    settings.mambo->calibration_time = setup.mission.start.start_up;
    validate(*settings.mambo, "estimator");
  }
  settings.allocation = allocation(vehicle);
  if (setup.estimator == EstimatorKind::uquad)
    settings.uquad = {uquad_filter_settings(setup, vehicle.sensors, setup.mission.start.start_up),
                      RigidBody(vehicle),
                      speeds_of_wrench(settings.allocation, settings.allocation.wrench0)};
  if (const auto* cascade = std::get_if<CascadeController>(&setup.controller)) {
    CascadedPidSettings<double> law =
        cascaded_pid_settings(vehicle, cascade->gains, cascade->method, cascade->attitude_limit,
                              cascade->integrator_limit, cascade->back_calculation);
    law.velocity_feed_forward = cascade->velocity_feed_forward;
    law.conditional_integration = cascade->conditional_integration;
    settings.law = law;
  } else {
    const auto& feedback = std::get<StateFeedbackController>(setup.controller);
    settings.law = state_feedback_settings(vehicle, feedback.gains, feedback.dt, feedback.guards);
  }
  settings.limits = thrust_limits(vehicle);
  settings.motor = vehicle.motor;
  settings.direction.fill(1);
  for (std::size_t i = 0; i < vehicle.motor.direction.size(); ++i)
    settings.direction[i] = vehicle.motor.direction[i];
  return settings;
}

}  // namespace exports
}  // namespace quadtune
