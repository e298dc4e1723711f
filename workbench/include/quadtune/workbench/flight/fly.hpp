// SPDX-License-Identifier: Apache-2.0
/// Flies a mission with a vehicle and evaluates the flight.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/flight_code_check.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// The verdict of one of several flights that differ only in their seed.
struct SeedVerdict {
  std::uint64_t seed = 0;                ///< of the flight
  bool passed = false;                   ///< the verdict
  FlightEnd end = FlightEnd::completed;  ///< how the flight ended
  MetricValues metrics;                  ///< of the flight
  std::string reason;                    ///< the first of reasons(); empty if it passed
};

/// A simulated flight and its verdict.
struct FlownFlight {
  PlannedFlight plan;   ///< from which it was flown
  FlightResult result;  ///< end, metrics and log
  Verdict verdict;      ///< according to the mission's limits
  double wall_s = 0;    ///< computing time [s]
  bool passed = false;  ///< the mission's limits hold, and the flown loop is not unstable
  /// The flown loop at the mission's hover, if judge_loop() was called. A flight with an unstable
  /// loop fails.
  std::optional<FlownLoop> loop = {};
  /// of the flights that worst_of() combined; empty for a single flight
  std::vector<SeedVerdict> seeds = {};
  std::string variant = {};  ///< "gust" or "load" for a disturbed flight of a design, else empty
};

/// The flown loop of a plan at a hover at its mission's height, without margins; none if no law
/// flies, that is for a motor test and for a carried vehicle.
/// @throws InvalidInput  as flown_loop()
[[nodiscard]] std::optional<FlownLoop> hover_loop(const PlannedFlight& plan);

/// Analyses the flown loop of a flight at the height of its hover, and fails the flight if the loop
/// is unstable. Does nothing for a flight without a control law.
/// @throws InvalidInput  as flown_loop()
void judge_loop(FlownFlight& flight);

/// Plans, flies and evaluates a flight as `quadtune fly` does, for a vehicle in memory.
///
///     const FlownFlight hover = fly(load_vehicle("mambo"));
///     for (const std::string& why : reasons(hover)) std::cerr << why << '\n';
///
/// @param vehicle  valid
/// @param options  `vehicle` is ignored
/// @param stop     called regularly; if it returns true, Interrupted is thrown
/// @throws OptionError   if an option does not accept its value; names the option
/// @throws InvalidInput  if the mission or a gain file cannot be flown
/// @throws NoSolution    if no law can be designed
/// @throws FileError, Interrupted
[[nodiscard]] FlownFlight fly(const Vehicle& vehicle, const FlightOptions& options = {},
                              const std::function<bool()>& stop = {});

/// Flies and evaluates a planned flight.
/// @param plan  from plan_flight()
/// @param stop  as fly()
[[nodiscard]] FlownFlight fly_planned(PlannedFlight plan, const std::function<bool()>& stop = {});

/// Flies a planned flight with the seeds s, s + 1, …, s + count - 1, where s is the plan's.
/// @param plan   from plan_flight()
/// @param count  ≥ 1
/// @param stop   as fly()
/// @return       one result of fly_planned() per seed
/// @throws       as fly()
[[nodiscard]] std::vector<FlownFlight> fly_seeds(const PlannedFlight& plan, std::uint32_t count,
                                                 const std::function<bool()>& stop = {});

/// Sets the law and the estimator of the options to those of the program in `options.gains`, an
/// export of flight code; "truth" if the program expects the estimate from its caller.
/// @throws OptionError              if the options name another law or estimator, or an integrator
/// @throws FileError, InvalidInput  if the path is not an export of flight code
void take_program(FlightOptions& options);

/// Flies a planned flight as fly_seeds() does, but with the compiled program of an export of flight
/// code instead of the law, the estimator and the allocation.
/// @param plan       its law was read from `directory`
/// @param directory  export from which the law of the plan was read
/// @param target     host or ARM under an emulator
/// @param count      number of seeds, ≥ 1
/// @param stop       as fly()
/// @throws OptionError              if the plan clips its commands
/// @throws FileError, InvalidInput  as CompiledProgram
[[nodiscard]] std::vector<FlownFlight> fly_compiled(const PlannedFlight& plan,
                                                    const std::string& directory,
                                                    FlightCodeTarget target, std::uint32_t count,
                                                    const std::function<bool()>& stop = {});

/// The first flight that failed, or the first one if none did, with the verdicts of all in `seeds`.
/// @param flights  at least one
[[nodiscard]] FlownFlight worst_of(std::vector<FlownFlight> flights);

/// The label of a metric, e.g. "maximum tilt" for "tilt_max".
[[nodiscard]] std::string label_of(Metric metric);

/// A metric's value with its unit: "0.0123 m"; "undefined" if it has no value, "never" if it is
/// infinite.
[[nodiscard]] std::string describe(Metric metric, double value);

/// Why a flight failed, one sentence each; empty if it passed.
[[nodiscard]] std::vector<std::string> reasons(const FlownFlight& flight);

}  // namespace quadtune
