// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/fly.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <utility>

namespace quadtune {

FlownFlight fly(const Vehicle& vehicle, const FlightOptions& options,
                const std::function<bool()>& stop) {
  return fly_planned(plan_flight(options, vehicle, vehicle.name), stop);
}

FlownFlight fly_planned(PlannedFlight plan, const std::function<bool()>& stop) {
  FlownFlight flight;
  flight.plan = std::move(plan);
  const auto begin = std::chrono::steady_clock::now();
  flight.result = fly(flight.plan.setup, stop);
  flight.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  Mission judged = flight.plan.setup.mission;
  judged.duration = duration_of(flight.plan.setup);
  flight.verdict = judge(judged, flight.result.metrics);
  flight.passed = flight.verdict.ok && flight.result.end == FlightEnd::completed;
  return flight;
}

std::string label_of(Metric metric) {
  switch (metric) {
    case Metric::duration:
      return "time flown";
    case Metric::settling_time:
      return "settling time";
    case Metric::overshoot:
      return "overshoot";
    case Metric::yaw_overshoot:
      return "overshoot of yaw";
    case Metric::tracking_rms:
      return "tracking error, rms";
    case Metric::tracking_max:
      return "tracking error, greatest";
    case Metric::height_rms:
      return "height error, rms";
    case Metric::height_max:
      return "height error, greatest";
    case Metric::yaw_rms:
      return "yaw error, rms";
    case Metric::yaw_max:
      return "yaw error, greatest";
    case Metric::tilt_max:
      return "greatest tilt";
    case Metric::speed_max:
      return "greatest speed";
    case Metric::saturation_time:
      return "time at a motor's limit";
    case Metric::energy:
      return "energy of the motors";
    case Metric::estimate_rms:
      return "position believed wrong, rms";
    case Metric::estimate_max:
      return "position believed wrong, greatest";
    case Metric::position_drift:
      return "drift of the believed position";
    case Metric::final_distance:
      return "distance at the end";
    case Metric::touchdown_speed:
      return "speed at touchdown";
  }
  return "";
}

std::string in_words(Metric metric, double value) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return "never";
  const std::string& unit = unit_of(metric);
  return fmt::format("{:.4g}{}", value, unit == "1" ? "" : " " + unit);
}

void judge_loop(FlownFlight& flight) {
  const MissionKind& kind = flight.plan.setup.mission.kind;
  if (std::holds_alternative<MotorTest>(kind) || std::holds_alternative<Carried>(kind)) return;
  FlownLoopOptions at;
  at.evidence = MarginsEvidence::none;
  if (const auto* hover = std::get_if<Hover>(&kind); hover != nullptr && hover->position.z() < 0)
    at.height = -hover->position.z();
  flight.loop = flown_loop(flight.plan, at);
  if (flight.loop->grows()) flight.passed = false;
}

std::vector<std::string> reasons(const FlownFlight& flight) {
  std::vector<std::string> why;
  const FlightResult& result = flight.result;
  if (flight.loop && flight.loop->grows())
    why.push_back(fmt::format("the flown loop is unstable at {} m, largest |z| {:.6f}: {}; {}",
                              flight.loop->at.height, std::abs(flight.loop->mode.z),
                              in_words(*flight.loop), what_helps(flight.plan, *flight.loop)));
  if (result.end == FlightEnd::diverged)
    why.push_back(fmt::format("diverged at {:.4g} s: state {} left every range that means anything",
                              result.end_time, result.culprit));
  if (result.end == FlightEnd::safety_exit && !result.events.empty()) {
    const LogEvent& last = result.events.back();
    why.push_back(fmt::format("safety exit '{}' at {:.4g} s{}", last.name, last.time,
                              last.detail.empty() ? "" : ": " + last.detail));
  }
  for (const LimitCheck& check : flight.verdict.checks) {
    // What a flight that ended early did not come to is no further reason.
    const bool ended = flight.result.end != FlightEnd::completed;
    if (check.ok || (ended && (check.metric == Metric::duration || std::isnan(check.value))))
      continue;
    why.push_back(fmt::format(
        "{} is {}, expected {} {}", label_of(check.metric), in_words(check.metric, check.value),
        check.at_least ? "at least" : "at most", in_words(check.metric, check.bound)));
  }
  return why;
}

}  // namespace quadtune
