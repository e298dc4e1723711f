// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "report/flights/flights.hpp"
#include "report/loops/loops.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

const WidenedLimit* widened_of(const PlannedFlight& plan, Metric metric) {
  for (const WidenedLimit& widened : plan.widened)
    if (widened.what == name_of(metric)) return &widened;
  return nullptr;
}

Json bound_json(const PlannedFlight& plan) {
  const MissionBound& bound = *plan.bound;
  const auto size = [](const ErrorSize& error) {
    return Json{
        {"rms", error.rms}, {"rms_rarely", error.rms_rarely}, {"most_rarely", error.most_rarely}};
  };
  Json json = {{"sensors", bound.bound.used},
               {"height_m", bound.options.height},
               {"tracking_m", size(bound.tracking)},
               {"horizontal_rms_m", bound.horizontal_rms},
               {"vertical_m", size(bound.height)},
               {"yaw_rad", size(bound.heading)},
               {"estimate_m", size(bound.estimate)},
               {"at_the_end", Json{{"horizontal_rms_m", bound.horizontal_end},
                                   {"vertical_rms_m", bound.height_end},
                                   {"yaw_rms_rad", bound.heading_end}}}};
  json["widened"] = Json::array();
  for (const WidenedLimit& widened : plan.widened)
    json["widened"].push_back({{"what", widened.what},
                               {"unit", widened.unit},
                               {"asked", widened.asked},
                               {"sensors_rms", widened.bound},
                               {"judged_by", widened.judged}});
  return json;
}

/// The error bound of the sensors, and the limits that follow from it.
std::string bound_text(const PlannedFlight& plan) {
  if (!plan.bound) return "";
  const MissionBound& bound = *plan.bound;
  std::string text = "\nbound of the sensors, rms (best filter for any law)\n";
  text += fmt::format("  position {:.3g} m, height {:.3g} m, yaw {:.3g} rad; ", bound.tracking.rms,
                      bound.height.rms, bound.heading.rms);
  text += fmt::format("at the end {:.3g} m\n", std::hypot(bound.horizontal_end, bound.height_end));
  for (const WidenedLimit& widened : plan.widened) {
    const std::string unit = widened.unit == "1" ? "" : " " + widened.unit;
    text += fmt::format("  {:<34} limit {:.4g}{} widened to {:.4g}{}\n", widened.label,
                        widened.asked, unit, widened.judged, unit);
  }
  return text;
}

Json diagnosis_json(const Diagnosis& diagnosis) {
  const FlightEvidence& evidence = diagnosis.evidence;
  return {{"cause", to_string(diagnosis.cause)},
          {"why", diagnosis.why},
          {"next", diagnosis.next},
          {"passes_with_true_states", evidence.passes_with_true_states},
          {"passes_with_ideal_sensors", evidence.passes_with_ideal_sensors},
          {"saturation", evidence.saturation},
          {"saturation_with_true_states", evidence.saturation_with_true_states},
          {"estimate_rms_m", evidence.estimate_rms},
          {"bound_rms_m", evidence.bound_rms},
          {"largest_pole", evidence.largest_pole}};
}

Json seeds_json(const std::vector<SeedVerdict>& seeds) {
  Json json = Json::array();
  for (const SeedVerdict& seed : seeds) {
    Json entry = {{"seed", seed.seed},
                  {"verdict", seed.passed ? "pass" : "fail"},
                  {"end", to_string(seed.end)}};
    if (!seed.reason.empty()) entry["reason"] = seed.reason;
    json.push_back(entry);
  }
  return json;
}

Json metrics_json(const MetricValues& values) {
  Json json = Json::object();
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    const std::string& unit = unit_of(metric);
    const std::string key = name_of(metric) + (unit == "1" ? "" : "_" + unit);
    json[key] = values[metric];
  }
  return json;
}

Json limits_json(const FlownFlight& flight) {
  Json json = Json::array();
  for (const LimitCheck& check : flight.verdict.checks) {
    json.push_back({{"metric", name_of(check.metric)},
                    {"value", check.value},
                    {check.at_least ? "at_least" : "at_most", check.bound},
                    {"ok", check.ok}});
    if (const WidenedLimit* widened = widened_of(flight.plan, check.metric)) {
      json.back()["asked"] = widened->asked;
      json.back()["sensors_rms"] = widened->bound;
    }
  }
  return json;
}

/// @param state  (12 or more) in the order of ned_convention()
Json state_json(const Eigen::VectorXd& state) {
  Json json = Json::object();
  const std::vector<std::string> names = names_or_numbers(ned_convention().states, 12);
  for (std::size_t i = 0; i < 12; ++i) json[names[i]] = state(static_cast<Eigen::Index>(i));
  return json;
}

const LimitCheck* limit_of_flight(const FlownFlight& flight, Metric metric) {
  for (const LimitCheck& check : flight.verdict.checks)
    if (check.metric == metric) return &check;
  return nullptr;
}

std::string flight_metrics_text(const FlownFlight& flight) {
  Cells cells;
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    const double value = flight.result.metrics[metric];
    const LimitCheck* check = limit_of_flight(flight, metric);
    if (std::isnan(value) && check == nullptr) continue;
    std::string limit;
    if (check != nullptr)
      limit = fmt::format("{} {}{}{}", check->at_least ? "at least" : "at most",
                          describe(metric, check->bound),
                          widened_of(flight.plan, metric) != nullptr ? " (widened)" : "",
                          check->ok ? "" : "  VIOLATED");
    cells.push_back({"  " + label_of(metric), describe(metric, value), limit});
  }
  return cells.empty() ? "" : aligned(cells, "<") + "\n";
}

}  // namespace

std::string surroundings(const PlannedFlight& plan) {
  return fmt::format("estimator {}, {} sensors, wind {}", plan.estimator, plan.sensors, plan.wind);
}

std::string circumstances(const PlannedFlight& plan) {
  return fmt::format("{}; {}, seed {}", plan.law, surroundings(plan), plan.setup.seed);
}

Json to_json(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis) {
  const FlightResult& result = flight.result;
  const FlightSetup& setup = flight.plan.setup;
  Json json = {{"vehicle", setup.vehicle.name},
               {"mission", setup.mission.name},
               {"law", flight.plan.law},
               {"estimator", flight.plan.estimator},
               {"sensors", flight.plan.sensors},
               {"flow", to_string(setup.flow)},
               {"wind", flight.plan.wind},
               {"seed", setup.seed},
               {"verdict", flight.passed ? "pass" : "fail"},
               {"end", to_string(result.end)},
               {"end_time_s", result.end_time}};
  if (!result.culprit.empty()) json["culprit"] = result.culprit;
  json["metrics"] = metrics_json(result.metrics);
  json["limits"] = limits_json(flight);
  if (flight.plan.bound) json["sensor_bound"] = bound_json(flight.plan);
  if (flight.loop) json["flown_loop"] = to_json(*flight.loop);
  json["reasons"] = reasons(flight);
  if (diagnosis && diagnosis->cause != FlightCause::none)
    json["diagnosis"] = diagnosis_json(*diagnosis);
  if (!flight.variant.empty()) json["disturbance"] = flight.variant;
  if (!flight.seeds.empty()) json["seeds"] = seeds_json(flight.seeds);
  json["events"] = Json::array();
  for (const LogEvent& event : result.events)
    json["events"].push_back({{"t", event.time}, {"name", event.name}, {"detail", event.detail}});
  json["final_state"] = state_json(result.final_state);
  json["final_estimate"] = state_json(result.final_estimate);
  json["steps"] = result.steps;
  json["wall_s"] = flight.wall_s;
  return json;
}

std::string to_text(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis) {
  const FlightResult& result = flight.result;
  const FlightSetup& setup = flight.plan.setup;
  std::string text =
      fmt::format("{} flies {}: {}\n  {}\n\n", setup.vehicle.name, setup.mission.name,
                  setup.mission.description, circumstances(flight.plan));
  const std::vector<std::string> why = reasons(flight);
  text += fmt::format("verdict: {}\n", flight.passed ? "pass" : "fail");
  for (const std::string& reason : why) text += "  " + reason + "\n";
  if (diagnosis && diagnosis->cause != FlightCause::none)
    text += fmt::format("why: {}\nnext: {}\n", diagnosis->why, diagnosis->next);
  text += "\n";
  text += flight_metrics_text(flight);
  text += bound_text(flight.plan);
  if (!result.events.empty()) text += "\nevents\n";
  for (const LogEvent& event : result.events)
    text += fmt::format("  {:>8.3f} s  {}{}\n", event.time, event.name,
                        event.detail.empty() ? "" : ": " + event.detail);
  text += fmt::format("\n{:.4g} s in {:.2g} s of computing, {} steps of {}\n", result.end_time,
                      flight.wall_s, result.steps, to_string(setup.integrator));
  return text;
}

namespace {

std::string seeds_table(const std::vector<SeedVerdict>& seeds) {
  Cells cells = {{"seed", "verdict", "rms", "greatest", "end", "settled", "yaw", "tilt", "limited"},
                 {"", "", "[m]", "[m]", "[m]", "[s]", "[rad]", "[rad]", "motor [s]"}};
  for (const SeedVerdict& seed : seeds) {
    cells.push_back({fmt::format("{}", seed.seed), seed.passed ? "pass" : "FAIL"});
    for (const Metric metric :
         {Metric::tracking_rms, Metric::tracking_max, Metric::final_distance, Metric::settling_time,
          Metric::yaw_max, Metric::tilt_max, Metric::saturation_time})
      cells.back().push_back(reached(seed.metrics[metric], ".3g"));
  }
  return aligned(cells, "><>") + "\n";
}

}  // namespace

internal::Json to_json(const std::vector<FlownFlight>& flights,
                       const std::optional<Diagnosis>& diagnosis) {
  internal::Json json = internal::Json::array();
  bool failed = false;
  for (const FlownFlight& flight : flights) {
    const bool first_failed = !flight.passed && !failed;
    json.push_back(to_json(flight, first_failed ? diagnosis : std::nullopt));
    failed = failed || first_failed;
  }
  return json;
}

std::string to_text(const std::vector<FlownFlight>& flights,
                    const std::optional<Diagnosis>& diagnosis) {
  const FlownFlight worst = worst_of(flights);
  const auto passed = std::count_if(flights.begin(), flights.end(),
                                    [](const FlownFlight& flight) { return flight.passed; });
  return fmt::format("verdict of {} seeds: {}, {} passed\n", flights.size(),
                     worst.passed ? "pass" : "fail", passed) +
         seeds_table(worst.seeds) +
         fmt::format("\n{}, seed {}\n", worst.passed ? "the first" : "the first that failed",
                     worst.plan.setup.seed) +
         to_text(worst, diagnosis);
}

}  // namespace quadtune::report
