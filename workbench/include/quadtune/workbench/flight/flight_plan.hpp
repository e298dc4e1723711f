// SPDX-License-Identifier: Apache-2.0
/// Converts options to a flight setup, and reports the defaults that were chosen.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flight/widened_limits.hpp"

namespace quadtune {

/// A flight setup, with a description of its choices.
struct PlannedFlight {
  FlightSetup setup;                     ///< for quadtune::fly()
  FlightOptions options = {};            ///< from which it was planned
  std::string law;                       ///< ChosenLaw::words
  std::optional<MarginsReport> margins;  ///< ChosenLaw::margins
  std::string estimator;                 ///< e.g. "mambo"
  std::string sensors;                   ///< "real" or "ideal"
  std::string wind;                      ///< as in the options
  std::vector<std::string> notes;        ///< notes about the choices, for the user
  /// Bound on the estimate along the mission; none if the sensors do not limit it.
  std::optional<MissionBound> bound = {};
  std::vector<WidenedLimit> widened = {};  ///< limits of setup.mission that were widened to the
                                           ///< bound
};

/// Sets the unset options as in the experiments of the model project: published gains if the
/// vehicle has them, ideal sensors, a take-off with constant thrust, and commands that are clipped
/// at the motors' limits.
/// @throws OptionError  if the controller is unknown
[[nodiscard]] FlightOptions as_the_model_project(FlightOptions options);

/// Rejects unknown words of the options before anything is designed or flown.
/// @throws OptionError  naming the option
void require_flight_words(const FlightOptions& options);

/// Plans a flight with the vehicle, mission and law that the options name.
/// @param options  of the flight
/// @param who      name of the caller, e.g. "fly", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution
[[nodiscard]] PlannedFlight plan_flight(const FlightOptions& options, const std::string& who);

/// The same for a vehicle in memory.
[[nodiscard]] PlannedFlight plan_flight(const FlightOptions& options, const Vehicle& vehicle,
                                        const std::string& who);

/// The same for a vehicle, a mission and a law in memory; the options that name them are ignored.
/// @throws OptionError, InvalidInput
[[nodiscard]] PlannedFlight plan_flight(const FlightOptions& options, const Vehicle& vehicle,
                                        const Mission& mission, const ChosenLaw& law);

/// Why the vehicle's own sensors do not suffice for any estimator; empty if they do.
[[nodiscard]] std::string why_no_estimator(const Vehicle& vehicle);

/// The estimator, with its numbers, of a flight of the vehicle with its own sensors.
/// @param vehicle  with its sensors
/// @param name     as in FlightOptions::estimator; empty: according to the sensors
/// @param dt       control period [s]
/// @return         no value for true states
[[nodiscard]] std::optional<StoredEstimator> stored_estimator(const Vehicle& vehicle,
                                                              const std::string& name, double dt);

/// Enables logging of every control period of the flight.
/// @throws OptionError  if the log would not fit into memory
void keep_log(PlannedFlight& plan);

}  // namespace quadtune
