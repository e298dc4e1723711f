// SPDX-License-Identifier: Apache-2.0
/// Compares two flights of one mission that differ in a single option.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/model/sensors.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {

/// One recorded quantity in both flights.
struct ColumnDifference {
  std::string column;       ///< of the log
  std::string name;         ///< short: "T", "tau_x", "px" …
  std::string unit;         ///< of the column
  double mean_squared = 0;  ///< [unit²]
  double max = 0;           ///< maximum magnitude [unit]
  double max_at = 0;        ///< time of the maximum [s]
};

/// Differences over the rows that both flights have.
struct FlightDifference {
  double duration = 0;                    ///< [s]
  std::vector<ColumnDifference> columns;  ///< one for each quantity
};

/// @param a, b  logs with equal control periods; quantities that one of them lacks are omitted
[[nodiscard]] FlightDifference difference_of(const LogTable& a, const LogTable& b);

/// The distance between the estimated and the true horizontal position.
struct EstimateError {
  double mean_absolute = 0;  ///< [m]
  double max = 0;            ///< [m]
  double final = 0;          ///< [m]
};

/// @param log  log of a flight, with x.px, x.py, estimate.px and estimate.py
[[nodiscard]] EstimateError estimate_error(const LogTable& log);

/// Two flights that differ in a single option.
struct FlightPair {
  std::string what;                      ///< "integrators", "flow", "filter" or "gains"
  std::string option;                    ///< key of the option that differs, e.g. "integrator"
  std::array<std::string, 2> names;      ///< e.g. "euler" and "tustin"
  std::array<FlightOptions, 2> options;  ///< one for each flight
};

/// The valid values of FlightPair::what.
[[nodiscard]] const std::vector<std::string>& compared_things();

/// The sensor that a comparison requires and a vehicle lacks, e.g. "sonar"; empty if it lacks none.
/// @param what             one of compared_things()
/// @param usual_estimator  whether FlightOptions::estimator is empty
/// @param sensors          of the vehicle
[[nodiscard]] std::string missing_sensor(const std::string& what, bool usual_estimator,
                                         const Sensors& sensors);

/// Forward Euler and Tustin integration of the PID's integrals; the simplified and the full model
/// of the optical flow, both with as_the_model_project(); the position from the filtered velocity
/// and from the flow velocity; or two gains.
/// @param what    one of compared_things()
/// @param flight  options that both flights share
/// @param gains   the two gains to compare, as in FlightOptions::gains; used for "gains" only
/// @throws OptionError  if `flight` sets the option that is compared
[[nodiscard]] FlightPair flight_pair(const std::string& what, FlightOptions flight,
                                     const std::array<std::string, 2>& gains = {});

/// Plans both flights, so that an error in the second is reported before the first is flown.
/// @param pair  from flight_pair()
/// @param who   name of the caller, e.g. "compare", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution  as plan_flight() and keep_log()
[[nodiscard]] std::array<PlannedFlight, 2> plan_both(const FlightPair& pair,
                                                     const std::string& who);

/// Two flights with their logs.
struct ComparedFlights {
  std::string what;                    ///< as FlightPair
  std::array<std::string, 2> names;    ///< as FlightPair
  std::array<FlownFlight, 2> flights;  ///< with their logs
  FlightDifference difference;         ///< of the second from the first
};

/// Flies both with fly_planned().
/// @param pair   from flight_pair()
/// @param plans  from plan_both()
/// @param stop   called regularly; if it returns true, Interrupted is thrown
/// @throws Interrupted  if `stop` returned true
[[nodiscard]] ComparedFlights fly_both(const FlightPair& pair, std::array<PlannedFlight, 2> plans,
                                       const std::function<bool()>& stop = {});

}  // namespace quadtune
