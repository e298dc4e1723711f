// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/fly.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/included_estimator.hpp"
#include "quadtune/exports/read_gains.hpp"

namespace quadtune {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

FlownFlight judged(PlannedFlight plan, FlightResult result, double wall_s) {
  FlownFlight flight;
  flight.plan = std::move(plan);
  flight.result = std::move(result);
  flight.wall_s = wall_s;
  Mission mission = flight.plan.setup.mission;
  mission.duration = duration_of(flight.plan.setup);
  flight.verdict = judge(mission, flight.result.metrics);
  flight.passed = flight.verdict.ok && flight.result.end == FlightEnd::completed;
  return flight;
}

}  // namespace

FlownFlight fly(const Vehicle& vehicle, const FlightOptions& options,
                const std::function<bool()>& stop) {
  return fly_planned(plan_flight(options, vehicle, vehicle.name), stop);
}

FlownFlight fly_planned(PlannedFlight plan, const std::function<bool()>& stop) {
  const auto begin = std::chrono::steady_clock::now();
  FlightResult result = fly(plan.setup, stop);
  const double wall = seconds_since(begin);
  return judged(std::move(plan), std::move(result), wall);
}

std::vector<FlownFlight> fly_seeds(const PlannedFlight& plan, std::uint32_t count,
                                   const std::function<bool()>& stop) {
  if (count == 0) throw OptionError("seeds", "seeds is 0, expected 1 or more");
  std::vector<FlightSetup> setups(count, plan.setup);
  for (std::uint32_t i = 0; i < count; ++i) setups[i].seed = plan.setup.seed + i;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<FlightResult> results = fly_all(setups, 0, stop);
  const double wall = seconds_since(begin) / count;
  std::vector<FlownFlight> flights;
  for (std::uint32_t i = 0; i < count; ++i) {
    PlannedFlight one = plan;
    one.setup = std::move(setups[i]);
    flights.push_back(judged(std::move(one), std::move(results[i]), wall));
  }
  return flights;
}

void take_program(FlightOptions& options) {
  const StoredLaws laws = read_laws(options.gains);
  const FlightCodeOptions program = read_flight_code_options(options.gains);
  const std::string& asked = program.law;
  const std::string estimator = included_estimator(laws.estimator, program.adapter);
  const bool cascade = asked.empty() ? laws.cascade.has_value() : asked == "cascaded-pid";
  const auto take = [](const char* option, std::string& word, const std::string& of_program) {
    if (!word.empty() && word != of_program)
      throw OptionError(option, fmt::format("{} is '{}', expected '{}', which the compiled program "
                                            "uses, or to be omitted",
                                            option, word, of_program));
    word = of_program;
  };
  take("controller", options.controller, cascade ? "cascaded-pid" : "state-feedback");
  take("estimator", options.estimator, estimator.empty() ? "truth" : estimator);
  if (!options.integrator.empty())
    throw OptionError("integrator", "integrator cannot be set for a compiled program");
}

std::vector<FlownFlight> fly_compiled(const PlannedFlight& plan, const std::string& directory,
                                      FlightCodeTarget target, std::uint32_t count,
                                      const std::function<bool()>& stop) {
  if (plan.setup.allocation != AllocationRule::prioritized)
    throw OptionError("compiled",
                      "compiled requires the default --allocation, "
                      "because flight code uses prioritized allocation");
  const CompiledProgram program(directory, plan.setup.vehicle, target);
  std::vector<FlownFlight> flights;
  for (std::uint32_t i = 0; i < count; ++i) {
    PlannedFlight one = plan;
    one.setup.seed = plan.setup.seed + i;
    one.law += target == FlightCodeTarget::arm ? ", flight code compiled for ARM"
                                               : ", compiled flight code";
    const auto begin = std::chrono::steady_clock::now();
    FlightResult result = program.fly(one.setup, stop).flight;
    const double wall = seconds_since(begin);
    flights.push_back(judged(std::move(one), std::move(result), wall));
  }
  return flights;
}

FlownFlight worst_of(std::vector<FlownFlight> flights) {
  std::vector<SeedVerdict> seeds;
  std::size_t worst = flights.size();
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const FlownFlight& flight = flights[i];
    const std::vector<std::string> why = reasons(flight);
    seeds.push_back({flight.plan.setup.seed, flight.passed, flight.result.end,
                     flight.result.metrics, why.empty() ? "" : why.front()});
    if (!flight.passed && worst == flights.size()) worst = i;
  }
  FlownFlight flight = std::move(flights.at(worst == flights.size() ? 0 : worst));
  flight.seeds = std::move(seeds);
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
      return "tracking error, maximum";
    case Metric::height_rms:
      return "height error, rms";
    case Metric::height_max:
      return "height error, maximum";
    case Metric::yaw_rms:
      return "yaw error, rms";
    case Metric::yaw_max:
      return "yaw error, maximum";
    case Metric::tilt_max:
      return "maximum tilt";
    case Metric::speed_max:
      return "maximum speed";
    case Metric::saturation_time:
      return "time at a motor's limit";
    case Metric::energy:
      return "energy of the motors";
    case Metric::estimate_rms:
      return "position estimate error, rms";
    case Metric::estimate_max:
      return "position estimate error, maximum";
    case Metric::position_drift:
      return "drift of the position estimate";
    case Metric::final_distance:
      return "distance at the end";
    case Metric::touchdown_speed:
      return "speed at touchdown";
    case Metric::height_peak:
      return "maximum height above the reference";
  }
  return "";
}

std::string describe(Metric metric, double value) {
  if (std::isnan(value)) return "undefined";
  if (std::isinf(value)) return "never";
  const std::string& unit = unit_of(metric);
  return fmt::format("{:.4g}{}", value, unit == "1" ? "" : " " + unit);
}

std::optional<FlownLoop> hover_loop(const PlannedFlight& plan) {
  const MissionKind& kind = plan.setup.mission.kind;
  if (std::holds_alternative<MotorTest>(kind) || std::holds_alternative<Carried>(kind)) return {};
  FlownLoopOptions at;
  at.evidence = MarginsEvidence::none;
  if (const auto* hover = std::get_if<Hover>(&kind); hover != nullptr && hover->position.z() < 0)
    at.height = -hover->position.z();
  return flown_loop(plan, at);
}

void judge_loop(FlownFlight& flight) {
  flight.loop = hover_loop(flight.plan);
  if (flight.loop && flight.loop->grows()) flight.passed = false;
}

std::vector<std::string> reasons(const FlownFlight& flight) {
  std::vector<std::string> why;
  const FlightResult& result = flight.result;
  if (flight.loop && flight.loop->grows())
    why.push_back(fmt::format("the flown loop is unstable at {} m, largest |z| {:.6f}: {}; {}",
                              flight.loop->at.height, std::abs(flight.loop->mode.z),
                              describe(*flight.loop), what_helps(flight.plan, *flight.loop)));
  if (result.end == FlightEnd::diverged)
    why.push_back(fmt::format("diverged at {:.4g} s: state {} left its plausible range",
                              result.end_time, result.culprit));
  if (result.end == FlightEnd::safety_exit && !result.events.empty()) {
    const LogEvent& last = result.events.back();
    why.push_back(fmt::format("safety exit '{}' at {:.4g} s{}", last.name, last.time,
                              last.detail.empty() ? "" : ": " + last.detail));
  }
  for (const LimitCheck& check : flight.verdict.checks) {
    // Metrics that an early end left undefined are not further reasons.
    const bool ended = flight.result.end != FlightEnd::completed;
    if (check.ok || (ended && (check.metric == Metric::duration || std::isnan(check.value))))
      continue;
    std::string reason =
        check.metric == Metric::settling_time && std::isnan(check.value)
            ? fmt::format(
                  "settling cannot be evaluated: no reference is constant for window_s = {:.4g} s "
                  "in a flight of {:.4g} s; expected a longer flight",
                  flight.plan.setup.mission.settling.window, result.end_time)
        : check.metric == Metric::settling_time && std::isinf(check.value)
            ? fmt::format("the vehicle does not settle, expected a settling time of at most {}",
                          describe(check.metric, check.bound))
            : fmt::format("{} is {}, expected {} {}", label_of(check.metric),
                          describe(check.metric, check.value),
                          check.at_least ? "at least" : "at most",
                          describe(check.metric, check.bound));
    for (const WidenedLimit& widened : flight.plan.widened)
      if (widened.what == name_of(check.metric)) reason += fmt::format(" ({})", describe(widened));
    why.push_back(std::move(reason));
  }
  return why;
}

}  // namespace quadtune
