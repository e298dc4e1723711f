// SPDX-License-Identifier: Apache-2.0
/// A flight told: as text, as JSON, as a page.
#pragma once

#include <string>

#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/fly.hpp"
#include "report/flight_report.hpp"

namespace quadtune::cli {

/// "cascaded PID, …; estimator mambo, real sensors, calm, seed 1"
[[nodiscard]] std::string circumstances(const PlannedFlight& plan);

/// "metrics", "limits", "verdict", "events", "final_state", "steps", "wall_s" and what was flown.
[[nodiscard]] internal::Json to_json(const FlownFlight& flight);
[[nodiscard]] std::string to_text(const FlownFlight& flight);

/// The page of a flight whose log was kept.
/// @param command  the command line that made it; may be empty
[[nodiscard]] FlightReport report_of(const FlownFlight& flight, const std::string& command);

}  // namespace quadtune::cli
