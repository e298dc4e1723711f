// SPDX-License-Identifier: Apache-2.0
#include "design_flights.hpp"

#include <fmt/format.h>

#include <cmath>

#include "flight_story.hpp"

namespace quadtune::cli {

using internal::Json;

Json missions_json(const DesignOutcome& outcome) {
  Json json = Json::array();
  for (const FlownFlight& flight : outcome.flights) json.push_back(to_json(flight));
  return json;
}

std::string missions_text(const DesignOutcome& outcome) {
  std::string text;
  for (const FlownFlight& flight : outcome.flights) {
    const MetricValues& metrics = flight.result.metrics;
    text += fmt::format("{}{}: {}; {:.4g} s flown", text.empty() ? "" : "\n",
                        flight.plan.setup.mission.name, flight.passed ? "pass" : "FAIL",
                        flight.result.end_time);
    for (const Metric metric :
         {Metric::settling_time, Metric::tracking_rms, Metric::tilt_max, Metric::energy})
      if (std::isfinite(metrics[metric]))
        text += fmt::format(", {} {:.3g} {}", label_of(metric), metrics[metric], unit_of(metric));
    text += "\n  " + circumstances(flight.plan);
    if (flight.loop)
      text += fmt::format("\n  flown loop: largest |z| {:.6f}: {}", std::abs(flight.loop->mode.z),
                          in_words(*flight.loop));
    for (const std::string& reason : reasons(flight)) text += "\n  " + reason;
  }
  return text;
}

}  // namespace quadtune::cli
