// SPDX-License-Identifier: Apache-2.0
/// From options in words to a flight that can be flown, and what was chosen where they say nothing.
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

/// A setup, and in words what was chosen for it.
struct PlannedFlight {
  FlightSetup setup;
  FlightOptions options = {};            ///< that it was planned from
  std::string law;                       ///< ChosenLaw::words
  std::optional<MarginsReport> margins;  ///< ChosenLaw::margins
  std::string estimator;                 ///< e.g. "mambo"
  std::string sensors;                   ///< "real" or "ideal"
  std::string wind;                      ///< as it was asked for
  std::vector<std::string> notes;        ///< what the user should know of a choice
  /// What the sensors can know along the mission; none where nothing limits the knowledge.
  std::optional<MissionBound> bound = {};
  std::vector<WidenedLimit> widened = {};  ///< limits of setup.mission that the bound has widened
};

/// Where nothing is said: published gains of a vehicle that has them, ideal sensors, a take-off by
/// constant thrust and commands that are clipped at the motors' limits, as the model project flew
/// its experiments.
/// @throws OptionError  for a word that is no controller
[[nodiscard]] FlightOptions as_the_model_project(FlightOptions options);

/// Refuses words that no option knows, before anything is designed or flown.
/// @throws OptionError
void require_flight_words(const FlightOptions& options);

/// The vehicle, mission and law that the options name.
/// @param who  asked, e.g. "fly", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution
[[nodiscard]] PlannedFlight plan_flight(const FlightOptions& options, const std::string& who);

/// The same for a vehicle in memory.
[[nodiscard]] PlannedFlight plan_flight(const FlightOptions& options, const Vehicle& vehicle,
                                        const std::string& who);

/// The same for a vehicle, a mission and a law in memory; their options are not looked at.
/// @throws OptionError, InvalidInput
[[nodiscard]] PlannedFlight plan_flight(const FlightOptions& options, const Vehicle& vehicle,
                                        const Mission& mission, const ChosenLaw& law);

/// Why a vehicle's own sensors feed no estimator, in words; empty: they feed one.
[[nodiscard]] std::string why_no_estimator(const Vehicle& vehicle);

/// The estimator of a flight of the vehicle with its own sensors, with its numbers.
/// @param name  as FlightOptions::estimator; empty: by the sensors
/// @param dt    control period [s]
/// @return      none for true states
[[nodiscard]] std::optional<StoredEstimator> stored_estimator(const Vehicle& vehicle,
                                                              const std::string& name, double dt);

/// Has every control period of the flight kept.
/// @throws OptionError  for a flight whose record would not fit into memory
void keep_log(PlannedFlight& plan);

}  // namespace quadtune
