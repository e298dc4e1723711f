// SPDX-License-Identifier: Apache-2.0
/// Two flights of one mission that differ in one thing, and where they part.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {

/// One recorded quantity in both flights.
struct ColumnDifference {
  std::string column;  ///< of the log
  std::string name;    ///< short: "T", "tau_x", "px" …
  std::string unit;
  double mean_squared = 0;  ///< [unit²]
  double max = 0;           ///< greatest size [unit]
  double max_at = 0;        ///< when [s]
};

/// Over the rows that both flights have.
struct FlightDifference {
  double duration = 0;  ///< [s]
  std::vector<ColumnDifference> columns;
};

/// @param a, b  logs of equal control periods; quantities that one of them lacks are left out
[[nodiscard]] FlightDifference difference_of(const LogTable& a, const LogTable& b);

/// The distance between the estimated and the true horizontal position.
struct EstimateError {
  double mean_absolute = 0;  ///< [m]
  double max = 0;            ///< [m]
  double final = 0;          ///< [m]
};

/// @param log  of a flight: with x.px, x.py, estimate.px and estimate.py
[[nodiscard]] EstimateError estimate_error(const LogTable& log);

/// Two flights whose logs were kept.
struct ComparedFlights {
  std::string what;  ///< that differs, e.g. "integrators"
  std::array<std::string, 2> names;
  std::array<FlownFlight, 2> flights;
  FlightDifference difference;
};

/// Plans both, so that a mistake in the second is told before the first flies.
/// @param who  asked, e.g. "compare", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution  as plan_flight() and keep_log()
[[nodiscard]] std::array<PlannedFlight, 2> plan_both(const std::array<FlightOptions, 2>& options,
                                                     const std::string& who);

/// Flies both, each like fly_planned().
/// @param names  of the flights
/// @throws Interrupted  where `stop` returned true
[[nodiscard]] ComparedFlights fly_both(std::string what, std::array<std::string, 2> names,
                                       std::array<PlannedFlight, 2> plans,
                                       const std::function<bool()>& stop = {});

}  // namespace quadtune
