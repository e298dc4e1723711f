// SPDX-License-Identifier: Apache-2.0
/// A vehicle flies a mission, and whether it flew well.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/workbench/flight_options.hpp"
#include "quadtune/workbench/flight_plan.hpp"
#include "quadtune/workbench/flown_loop.hpp"

namespace quadtune {

/// A flight that was flown, and judged by its mission.
struct FlownFlight {
  PlannedFlight plan;
  FlightResult result;
  Verdict verdict;    ///< of the mission's limits; it was flown to the end
  double wall_s = 0;  ///< time that the computer took [s]
  bool passed = false;
  /// Near the mission's hover, where somebody asked for it; a flight whose loop grows has not
  /// passed.
  std::optional<FlownLoop> loop = {};
};

/// Looks at the loop of a flight too, at the height of its hover. Flights without a law have none.
/// @throws InvalidInput  as flown_loop()
void judge_loop(FlownFlight& flight);

/// Plans, flies and judges: what `quadtune fly` does, for a vehicle in memory.
///
///     const FlownFlight hover = fly(load_vehicle("mambo"));
///     for (const std::string& why : reasons(hover)) std::cerr << why << '\n';
///
/// @param options  `vehicle` is not looked at
/// @param stop     asked now and then; true ends the flight with Interrupted
/// @throws OptionError   for a word that an option does not know, naming the option
/// @throws InvalidInput  for a mission or a file of gains that cannot be flown
/// @throws NoSolution    where no law can be designed
/// @throws FileError, Interrupted
[[nodiscard]] FlownFlight fly(const Vehicle& vehicle, const FlightOptions& options = {},
                              const std::function<bool()>& stop = {});

/// Flies and judges what was planned.
/// @param stop  as fly()
[[nodiscard]] FlownFlight fly_planned(PlannedFlight plan, const std::function<bool()>& stop = {});

/// "tilt_max" as "greatest tilt".
[[nodiscard]] std::string label_of(Metric metric);

/// A metric's value with its unit: "0.0123 m", "none" where it has none, "never" where it is
/// infinite.
[[nodiscard]] std::string in_words(Metric metric, double value);

/// Why a flight did not pass, a sentence each; empty where it did.
[[nodiscard]] std::vector<std::string> reasons(const FlownFlight& flight);

}  // namespace quadtune
