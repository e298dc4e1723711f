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

/// Two flights that differ in one thing.
struct FlightPair {
  std::string what;                  ///< "integrators", "flow", "filter" or "gains"
  std::array<std::string, 2> names;  ///< e.g. "euler" and "tustin"
  std::array<FlightOptions, 2> options;
};

/// What can differ.
[[nodiscard]] const std::vector<std::string>& compared_things();

/// Forward Euler and Tustin of the PID's integrals; the simplified model of the optical flow and
/// the full one, both as as_the_model_project(); the position by filtered velocity and by the
/// flow's own; or two gains.
/// @param what   one of compared_things()
/// @param gains  the two of "gains", as FlightOptions::gains; otherwise not used
/// @throws OptionError  for an option that is what differs
[[nodiscard]] FlightPair flight_pair(const std::string& what, FlightOptions flight,
                                     const std::array<std::string, 2>& gains = {});

/// Plans both, so that a mistake in the second is told before the first flies.
/// @param who  asked, e.g. "compare", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution  as plan_flight() and keep_log()
[[nodiscard]] std::array<PlannedFlight, 2> plan_both(const FlightPair& pair,
                                                     const std::string& who);

/// Two flights whose logs were kept.
struct ComparedFlights {
  std::string what;  ///< as FlightPair
  std::array<std::string, 2> names;
  std::array<FlownFlight, 2> flights;
  FlightDifference difference;
};

/// Flies both, each like fly_planned().
/// @param plans  of plan_both()
/// @throws Interrupted  where `stop` returned true
[[nodiscard]] ComparedFlights fly_both(const FlightPair& pair, std::array<PlannedFlight, 2> plans,
                                       const std::function<bool()>& stop = {});

}  // namespace quadtune
