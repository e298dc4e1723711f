// SPDX-License-Identifier: Apache-2.0
/// What the page of a flight shows: plots, replay, metrics, gains and margins.
#pragma once

#include <optional>
#include <string>

#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "report/page/flight_report.hpp"

namespace quadtune::report {

/// The page of a flight whose log was kept; html() makes a file of it.
/// @param command    the command line that made it; may be empty
/// @param diagnosis  of a flight that failed, if it was made
[[nodiscard]] FlightReport flight_page(const FlownFlight& flight, const std::string& command,
                                       const std::optional<Diagnosis>& diagnosis = {});

}  // namespace quadtune::report
