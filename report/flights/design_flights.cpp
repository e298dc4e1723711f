// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "report/flights/flights.hpp"

namespace quadtune::report {

using internal::Json;

namespace {

using Diagnoses = std::vector<std::optional<Diagnosis>>;

std::string name_of_flight(const FlownFlight& flight) {
  const std::string& mission = flight.plan.setup.mission.name;
  if (flight.variant == "gust")
    return fmt::format("{} with a gust of {:g} m/s", mission, kGustSpeed);
  if (flight.variant == "load")
    return fmt::format("{} with a load of {:g} % of the mass picked up", mission, 100 * kLoadShare);
  return mission;
}

std::string seeds_of(const FlownFlight& flight) {
  if (flight.seeds.size() < 2) return "";
  const auto passed = std::count_if(flight.seeds.begin(), flight.seeds.end(),
                                    [](const SeedVerdict& seed) { return seed.passed; });
  return fmt::format(" ({} of {} seeds)", passed, flight.seeds.size());
}

std::string text_of(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis) {
  const MetricValues& metrics = flight.result.metrics;
  std::string text =
      fmt::format("{}: {}{}; {:.4g} s flown", name_of_flight(flight),
                  flight.passed ? "pass" : "FAIL", seeds_of(flight), flight.result.end_time);
  for (const Metric metric :
       {Metric::settling_time, Metric::tracking_rms, Metric::tilt_max, Metric::energy})
    if (std::isfinite(metrics[metric]))
      text += fmt::format(", {} {:.3g} {}", label_of(metric), metrics[metric], unit_of(metric));
  text += "\n  " + circumstances(flight.plan);
  if (flight.loop)
    text += fmt::format("\n  flown loop: largest |z| {:.6f}: {}", std::abs(flight.loop->mode.z),
                        describe(*flight.loop));
  for (const WidenedLimit& widened : flight.plan.widened)
    if (flight.variant.empty()) text += fmt::format("\n  {}: {}", widened.label, describe(widened));
  for (const std::string& reason : reasons(flight)) text += "\n  " + reason;
  if (diagnosis) text += fmt::format("\n  why: {}\n  next: {}", diagnosis->why, diagnosis->next);
  return text;
}

}  // namespace

Json missions_json(const DesignOutcome& outcome, const MissionDiagnoses& diagnoses) {
  Json json = Json::array();
  const auto add = [&](const std::vector<FlownFlight>& flights, const Diagnoses& why) {
    for (std::size_t i = 0; i < flights.size(); ++i) json.push_back(to_json(flights[i], why[i]));
  };
  add(outcome.flights, diagnoses.flights);
  add(outcome.disturbed, diagnoses.disturbed);
  return json;
}

std::string missions_text(const DesignOutcome& outcome, const MissionDiagnoses& diagnoses) {
  std::string text;
  const auto add = [&](const std::vector<FlownFlight>& flights, const Diagnoses& why) {
    for (std::size_t i = 0; i < flights.size(); ++i)
      text += (text.empty() ? "" : "\n") + text_of(flights[i], why[i]);
  };
  add(outcome.flights, diagnoses.flights);
  add(outcome.disturbed, diagnoses.disturbed);
  return text;
}

}  // namespace quadtune::report
