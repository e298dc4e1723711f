// SPDX-License-Identifier: Apache-2.0
/// A flight told: as text, as JSON, as a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "report/page/flight_report.hpp"

namespace quadtune::report {

/// "cascaded PID, …; estimator mambo, real sensors, calm, seed 1"
[[nodiscard]] std::string circumstances(const PlannedFlight& plan);

/// "metrics", "limits", "verdict", "events", "final_state", "steps", "wall_s" and what was flown.
/// @param diagnosis  of a flight that failed, if it was made: "diagnosis"
[[nodiscard]] internal::Json to_json(const FlownFlight& flight,
                                     const std::optional<Diagnosis>& diagnosis = {});
[[nodiscard]] std::string to_text(const FlownFlight& flight,
                                  const std::optional<Diagnosis>& diagnosis = {});

/// A table of flights that differ in their seed, at most 80 columns wide.
[[nodiscard]] std::string seeds_table(const std::vector<SeedVerdict>& seeds);

/// The page of a flight whose log was kept.
/// @param command  the command line that made it; may be empty
[[nodiscard]] FlightReport report_of(const FlownFlight& flight, const std::string& command,
                                     const std::optional<Diagnosis>& diagnosis = {});

}  // namespace quadtune::report
