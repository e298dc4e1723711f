// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune {
namespace {

/// Share of a flight above which motors at their limits count as the cause.
constexpr double kSaturated = 0.1;
/// If a limit is exceeded by less than this factor, the mission is too tight; otherwise the law
/// fails.
constexpr double kNearly = 1.5;

/// Restores the limits of the mission's file.
void restore_limits(PlannedFlight& plan) {
  for (const WidenedLimit& widened : plan.widened)
    for (Limit& limit : plan.setup.mission.limits)
      if (name_of(limit.metric) == widened.what) limit.max = widened.asked;
  plan.setup.mission.settling.settled_band = 0;
  plan.setup.mission.settling.settled_yaw_band = 0;
  plan.widened.clear();
}

PlannedFlight with_true_states(PlannedFlight plan) {
  restore_limits(plan);
  plan.setup.estimator = EstimatorKind::truth;
  plan.setup.log = false;
  return plan;
}

PlannedFlight with_ideal_sensors(PlannedFlight plan) {
  restore_limits(plan);
  plan.setup.real_sensors = false;
  plan.setup.log = false;
  if (plan.setup.estimator == EstimatorKind::mambo) calibrate_flow(plan.setup);
  return plan;
}

double saturation_of(const FlownFlight& flight) {
  const double time = flight.result.metrics[Metric::saturation_time];
  const double flown = std::max(flight.result.end_time, 1e-9);
  return std::isfinite(time) ? time / flown : 0;
}

bool misses(const FlownFlight& flight, Metric metric) {
  return std::any_of(flight.verdict.checks.begin(), flight.verdict.checks.end(),
                     [&](const LimitCheck& check) { return check.metric == metric && !check.ok; });
}

/// The largest factor by which a limit is exceeded; infinite if the flight ended early.
double missed_by(const FlownFlight& flight) {
  if (flight.result.end != FlightEnd::completed) return INFINITY;
  double max = 0;
  for (const LimitCheck& check : flight.verdict.checks) {
    if (check.ok) continue;
    const double factor = check.bound > 0 ? check.value / check.bound : INFINITY;
    max = std::max(max, std::isnan(factor) ? INFINITY : factor);
  }
  return max;
}

/// Whether the flight is complete and fails only because metrics are undefined, such as settling in
/// a flight that is too short.
bool only_undefined(const FlownFlight& flight) {
  if (flight.result.end != FlightEnd::completed || flight.passed) return false;
  return std::all_of(flight.verdict.checks.begin(), flight.verdict.checks.end(),
                     [](const LimitCheck& check) { return check.ok || std::isnan(check.value); });
}

/// Describes the first limit that was exceeded.
std::string first_missed(const FlownFlight& flight) {
  for (const LimitCheck& check : flight.verdict.checks)
    if (!check.ok && !check.at_least)
      return fmt::format("{} {} (limit {})", label_of(check.metric),
                         describe(check.metric, check.value), describe(check.metric, check.bound));
  return fmt::format("{} at {:.3g} s", to_string(flight.result.end), flight.result.end_time);
}

bool measures_position(const Sensors& sensors) { return sensors.gps || sensors.vision; }

/// Whether errors of the estimate account for most of the excess over a limit.
bool explained_by_estimate(const FlownFlight& flight) {
  const double wrong = flight.result.metrics[Metric::estimate_max];
  for (const LimitCheck& check : flight.verdict.checks)
    if (!check.ok && unit_of(check.metric) == "m" && wrong >= check.value / 2) return true;
  return misses(flight, Metric::settling_time) &&
         wrong >= flight.plan.setup.mission.settling.band / 2;
}

/// The first event without which the law passes with true states; all events if only removing all
/// of them helps; none if the law also fails without any event.
std::vector<FlightEvent> events_at_fault(const PlannedFlight& plan) {
  const std::vector<FlightEvent>& events = plan.setup.mission.events;
  const auto passes_with = [&](const std::vector<FlightEvent>& kept) {
    PlannedFlight other = with_true_states(plan);
    other.setup.mission.events = kept;
    return fly_planned(std::move(other)).passed;
  };
  if (events.empty() || !passes_with({})) return {};
  if (events.size() == 1) return events;
  for (std::size_t i = 0; i < events.size(); ++i) {
    std::vector<FlightEvent> others = events;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (passes_with(others)) return {events[i]};
  }
  return events;
}

/// For example "motor 2 stops at 5 s and a load of 0.1 kg is dropped at 9 s".
std::string describe(const std::vector<FlightEvent>& events) {
  std::string text;
  for (const FlightEvent& event : events)
    text += fmt::format("{}{} at {:.3g} s", text.empty() ? "" : " and ", quadtune::describe(event),
                        event.time);
  return text;
}

/// Whether a motor fails that is needed to balance the torques.
bool loses_a_needed_motor(const PlannedFlight& plan, const std::vector<FlightEvent>& events) {
  return plan.setup.vehicle.rotors.size() <= 4 &&
         std::any_of(events.begin(), events.end(), [](const FlightEvent& event) {
           const auto* fault = std::get_if<MotorFault>(&event.what);
           return fault != nullptr && fault->thrust_share == 0;
         });
}

/// Whether a load makes the vehicle heavier than the maximum thrust of its laws.
bool too_heavy(const PlannedFlight& plan, const std::vector<FlightEvent>& events) {
  const Vehicle& flown = flown_vehicle(plan.setup);
  double mass = flown.mass;
  for (const FlightEvent& event : events)
    if (const auto* load = std::get_if<LoadChange>(&event.what)) mass += load->mass;
  const double fraction = plan.setup.vehicle.altitude_thrust_fraction;
  return mass > flown.mass &&
         mass * flown.gravity > max_thrust(flown) * (fraction > 0 ? fraction : 1);
}

/// The vehicle as an argument of a command: a file, or a built-in name.
std::string vehicle_of(const PlannedFlight& plan) {
  if (!plan.options.vehicle.empty()) return plan.options.vehicle;
  return place_of(plan.setup.vehicle);
}

std::string mission_of(const PlannedFlight& plan) {
  const Mission& mission = plan.setup.mission;
  return mission.file.empty() ? mission.name : mission.file.string();
}

bool is_cascade(const PlannedFlight& plan) {
  return std::holds_alternative<CascadeController>(plan.setup.controller);
}

/// The command for the same flight: "quadtune fly mambo --gains x --mission hover".
/// " --wind light" if there is wind, otherwise empty
std::string wind_option(const PlannedFlight& plan) {
  const std::string& wind = plan.options.wind;
  return wind.empty() || wind == "calm" ? "" : " --wind " + wind;
}

std::string fly_command(const PlannedFlight& plan) {
  std::string text = "quadtune fly " + vehicle_of(plan);
  if (!plan.options.gains.empty()) text += " --gains " + plan.options.gains;
  if (!plan.options.controller.empty()) text += " --controller " + plan.options.controller;
  return text + " --mission " + mission_of(plan) + wind_option(plan);
}

/// The word of `quadtune tune` for this law. The loops of an autopilot are tuned as a cascade.
const char* tuned_law(const PlannedFlight& plan) {
  return std::holds_alternative<StateFeedbackController>(plan.setup.controller) ? "lqr" : "pid";
}

/// The command that tunes gains for this mission.
std::string tune_command(const PlannedFlight& plan) {
  return fmt::format("quadtune tune {} {} --mission {}{}", tuned_law(plan), vehicle_of(plan),
                     mission_of(plan), wind_option(plan));
}

/// The command that shows the flown loop of this law; gains that are in no file must be written
/// first.
std::string margins_command(const PlannedFlight& plan) {
  const std::string& gains = plan.options.gains;
  const std::string vehicle = vehicle_of(plan);
  const auto* feedback = std::get_if<StateFeedbackController>(&plan.setup.controller);
  if (feedback != nullptr && feedback->schedule) return fly_command(plan) + " --estimator truth";
  if (!gains.empty() && gains != "designed" && gains != "published")
    return fmt::format("quadtune margins {} --gains {}", vehicle, gains);
  if (is_cascade(plan) && gains != "published")
    return fmt::format(
        "quadtune pid {0} --json > gains.json && quadtune margins {0} --gains "
        "gains.json",
        vehicle);
  return fly_command(plan) + " --estimator truth";
}

struct Loop {
  std::optional<FlownLoop> loop;
  bool grows = false;
};

Loop loop_of(const PlannedFlight& plan) {
  const MissionKind& kind = plan.setup.mission.kind;
  if (std::holds_alternative<MotorTest>(kind) || std::holds_alternative<Carried>(kind)) return {};
  FlownLoopOptions at;
  at.evidence = MarginsEvidence::none;
  if (plan.bound) at.height = plan.bound->options.height;
  if (const auto* hover = std::get_if<Hover>(&kind); hover != nullptr && hover->position.z() < 0)
    at.height = -hover->position.z();
  try {
    const FlownLoop loop = flown_loop(plan, at);
    return {loop, loop.grows()};
  } catch (const InvalidInput&) {
    return {};  // a loop that cannot be analysed provides no evidence
  }
}

FlightCause cause_of(const PlannedFlight& plan, const FlownFlight& flight, const FlownFlight& truth,
                     const FlightEvidence& evidence, const std::vector<FlightEvent>& at_fault) {
  if (std::holds_alternative<MotorTest>(plan.setup.mission.kind) || only_undefined(flight))
    return FlightCause::mission_limits;
  const bool flies = !std::holds_alternative<Carried>(plan.setup.mission.kind);
  if (flies && !evidence.passes_with_true_states) {
    if (!at_fault.empty()) return FlightCause::event;
    if (evidence.saturation_with_true_states > kSaturated || misses(truth, Metric::saturation_time))
      return FlightCause::motor_limits;
    return missed_by(truth) <= kNearly ? FlightCause::mission_limits : FlightCause::law;
  }
  if (plan.setup.estimator != EstimatorKind::truth && !evidence.passes_with_ideal_sensors)
    return FlightCause::estimator;
  if (flies && flight.result.end == FlightEnd::completed && !explained_by_estimate(flight))
    return FlightCause::noise;
  if (!(evidence.estimate_rms <= evidence.estimate_limit)) return FlightCause::estimator;
  return measures_position(sensors_of(plan.setup)) ? FlightCause::sensors : FlightCause::drift;
}

/// Writes the sentences `why` and `next` for a cause.
class Explanation {
 public:
  Explanation(const PlannedFlight& plan, const FlownFlight& flight, const FlownFlight& truth,
              Diagnosis& diagnosis)
      : plan_(plan), flight_(flight), truth_(truth), diagnosis_(diagnosis) {}

  void write(const Loop& loop, const std::vector<FlightEvent>& at_fault) {
    switch (diagnosis_.cause) {
      case FlightCause::none:
        return;
      case FlightCause::unstable_loop:
      case FlightCause::estimator_loop:
        return of_loop(*loop.loop);
      case FlightCause::event:
        return of_event(at_fault);
      case FlightCause::motor_limits:
        return of_motor_limits();
      case FlightCause::law:
        return of_law();
      case FlightCause::mission_limits:
        return of_mission_limits();
      case FlightCause::estimator:
        return of_estimator();
      case FlightCause::drift:
        return of_drift();
      case FlightCause::sensors:
        return of_sensors();
      case FlightCause::noise:
        return of_noise();
    }
  }

 private:
  void of_loop(const FlownLoop& loop) {
    diagnosis_.why = fmt::format("the flown loop is unstable, largest |z| {:.6f} ({}); {}",
                                 evidence_.largest_pole, describe(loop), what_helps(plan_, loop));
    diagnosis_.next = fmt::format(
        "{}weaker gains, `{}`; `{}` shows the loop",
        diagnosis_.cause == FlightCause::unstable_loop ? "" : "another `--estimator`, or ",
        tune_command(plan_), margins_command(plan_));
  }

  void of_event(const std::vector<FlightEvent>& at_fault) {
    const bool heavy = too_heavy(plan_, at_fault);
    const bool saturated = evidence_.saturation_with_true_states > kSaturated;
    diagnosis_.why =
        fmt::format("{}: with true states the law passes without it and fails with it: {}{}",
                    describe(at_fault), first_missed(truth_),
                    heavy       ? ", heavier than the maximum thrust of the law"
                    : saturated ? fmt::format(", a motor at its limit for {:.0f} % of the flight",
                                              100 * evidence_.saturation_with_true_states)
                                : "");
    const std::string copy = "a copy of the mission's file";
    if (loses_a_needed_motor(plan_, at_fault))
      diagnosis_.next = fmt::format(
          "no law holds the heading with one of {} rotors at rest: {} with thrust_share above 0",
          plan_.setup.vehicle.rotors.size(), copy);
    else if (heavy || saturated)
      diagnosis_.next = fmt::format("more thrust, or {} with a smaller [[event]]", copy);
    else
      diagnosis_.next = fmt::format(
          "`quadtune tune {} {} --mission FILE`, where FILE is {} with this [[event]], or a copy "
          "with wider [limits]",
          tuned_law(plan_), vehicle_of(plan_), copy);
  }

  void of_motor_limits() {
    diagnosis_.why = fmt::format(
        "the flight was repeated with true states: a motor is then at its limit for {:.0f} % of "
        "the time, so the gains require more than the motors can produce, or the mission more than "
        "the vehicle can fly",
        100 * evidence_.saturation_with_true_states);
    diagnosis_.next = fmt::format("`{}` finds gains within the limits", tune_command(plan_));
  }

  void of_law() {
    diagnosis_.why =
        fmt::format("the law alone fails{}: with true states, {}",
                    wind_option(plan_).empty() ? "" : " in this wind", first_missed(truth_));
    diagnosis_.next = fmt::format("`{}`", tune_command(plan_));
    if (is_cascade(plan_))
      diagnosis_.next +=
          fmt::format(", or faster loops: `quadtune pid {} --Ms-max 1.7 --tracking-max 1.5`",
                      vehicle_of(plan_));
  }

  void of_mission_limits() {
    if (only_undefined(flight_)) {
      diagnosis_.why = "a metric that has a limit is undefined in this flight";
      diagnosis_.next = "a longer flight, or a copy of the mission's file without this limit";
      return;
    }
    diagnosis_.why = fmt::format(
        "the mission's limits are tight for this law: with true states, {}", first_missed(truth_));
    diagnosis_.next = fmt::format("`{}`, or a copy of the mission's file with wider [limits]",
                                  tune_command(plan_));
  }

  void of_estimator() {
    diagnosis_.why =
        fmt::format("the estimator: the law {}, and {}", others(), what_the_estimate_knows());
    diagnosis_.next = "another `--estimator`";
    if (plan_.sensors != "ideal")
      diagnosis_.next += fmt::format("; `{} --sensors ideal` repeats the flight without noise",
                                     fly_command(plan_));
  }

  void of_drift() {
    diagnosis_.why = fmt::format("drift: no sensor measures the position, and {}; the law {}",
                                 what_the_estimate_knows(), others());
    diagnosis_.next = fmt::format(
        "[sensors.gps] or [sensors.vision] in the vehicle's file, or a shorter flight: `{} "
        "--duration {:.3g}`",
        fly_command(plan_), duration_of(plan_.setup) / 4);
  }

  void of_sensors() {
    diagnosis_.why =
        fmt::format("the sensors: {}; the law {}", what_the_estimate_knows(), others());
    diagnosis_.next =
        "better sensors in the vehicle's file, or a copy of the mission's file with wider [limits]";
  }

  void of_noise() {
    diagnosis_.why = fmt::format(
        "the law converts the noise of the estimate into motion: {}, motors at their limits for "
        "{:.0f} % of the flight; the law {}",
        first_missed(flight_), 100 * evidence_.saturation, others());
    diagnosis_.next = fmt::format("`{}` finds gains that react less", tune_command(plan_));
  }

  [[nodiscard]] std::string others() const {
    return fmt::format("{} with true states and {} with ideal sensors",
                       evidence_.passes_with_true_states ? "passes" : "fails",
                       evidence_.passes_with_ideal_sensors ? "passes" : "fails");
  }

  [[nodiscard]] std::string what_the_estimate_knows() const {
    std::string error =
        fmt::format("the position estimate has an error of {:.3g} m rms", evidence_.estimate_rms);
    if (!std::isfinite(evidence_.bound_rms)) return error;
    return fmt::format("{}; the optimal filter with these sensors would have {:.3g} m", error,
                       evidence_.bound_rms);
  }

  const PlannedFlight& plan_;
  const FlownFlight& flight_;
  const FlownFlight& truth_;
  Diagnosis& diagnosis_;
  const FlightEvidence& evidence_ = diagnosis_.evidence;
};

}  // namespace

constexpr internal::EnumName<FlightCause> kFlightCauses[] = {
    {FlightCause::none, "none"},
    {FlightCause::unstable_loop, "unstable loop"},
    {FlightCause::estimator_loop, "unstable loop with the estimator"},
    {FlightCause::event, "event"},
    {FlightCause::motor_limits, "motor limits"},
    {FlightCause::law, "law"},
    {FlightCause::mission_limits, "mission limits"},
    {FlightCause::estimator, "estimator"},
    {FlightCause::drift, "drift"},
    {FlightCause::sensors, "sensors"},
    {FlightCause::noise, "noise"}};

std::string to_string(FlightCause cause) { return internal::name_in(kFlightCauses, cause); }

Diagnosis diagnose(const PlannedFlight& plan, const FlownFlight& flight) {
  Diagnosis diagnosis;
  if (flight.passed) return diagnosis;
  FlightEvidence& evidence = diagnosis.evidence;
  const FlownFlight truth = fly_planned(with_true_states(plan));
  const FlownFlight ideal = fly_planned(with_ideal_sensors(plan));
  evidence.passes_with_true_states = truth.passed;
  evidence.passes_with_ideal_sensors = ideal.passed;
  evidence.end_with_true_states = truth.result.end;
  evidence.saturation = saturation_of(flight);
  evidence.saturation_with_true_states = saturation_of(truth);
  evidence.estimate_rms = flight.result.metrics[Metric::estimate_rms];
  if (plan.bound) {
    const ErrorSize& size = plan.bound->estimate;
    evidence.bound_rms = size.rms;
    evidence.estimate_limit = std::max(kRmsOverBound * size.rms, size.rms_rarely);
  }
  const std::vector<FlightEvent> at_fault =
      truth.passed ? std::vector<FlightEvent>() : events_at_fault(plan);
  const Loop loop = loop_of(plan);
  if (loop.loop) evidence.largest_pole = std::abs(loop.loop->mode.z);
  if (loop.grows)
    diagnosis.cause =
        plan.setup.estimator == EstimatorKind::truth || loop_of(with_true_states(plan)).grows
            ? FlightCause::unstable_loop
            : FlightCause::estimator_loop;
  else
    diagnosis.cause = cause_of(plan, flight, truth, evidence, at_fault);
  Explanation(plan, flight, truth, diagnosis).write(loop, at_fault);
  return diagnosis;
}

}  // namespace quadtune
