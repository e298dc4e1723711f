// SPDX-License-Identifier: Apache-2.0
/// A flight told: as text, as JSON, as a page.
#pragma once

#include <string>
#include <vector>

#include "flight_arguments.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/simulation/flight.hpp"
#include "report/flight_report.hpp"

namespace quadtune::cli {

/// A flight that was flown, and judged by its mission.
struct FlownFlight {
  PlannedFlight plan;
  FlightResult result;
  Verdict verdict;    ///< of the mission's limits; it was flown to the end
  double wall_s = 0;  ///< time that the computer took [s]
  bool passed = false;
};

/// Flies and judges.
[[nodiscard]] FlownFlight fly_planned(PlannedFlight plan);

/// "tilt_max" as "greatest tilt".
[[nodiscard]] std::string label_of(Metric metric);

/// "cascaded PID, …; estimator mambo, real sensors, calm, seed 1"
[[nodiscard]] std::string circumstances(const PlannedFlight& plan);

/// Why a flight did not pass, a sentence each; empty where it did.
[[nodiscard]] std::vector<std::string> reasons(const FlownFlight& flight);

/// "metrics", "limits", "verdict", "events", "final_state", "steps", "wall_s" and what was flown.
[[nodiscard]] internal::Json to_json(const FlownFlight& flight);
[[nodiscard]] std::string to_text(const FlownFlight& flight);

/// The page of a flight whose log was kept.
/// @param command  the command line that made it; may be empty
[[nodiscard]] FlightReport report_of(const FlownFlight& flight, const std::string& command);

}  // namespace quadtune::cli
