// SPDX-License-Identifier: Apache-2.0
/// The flown loop of a planned flight at hover: whether it is stable, its margins, and its slowest
/// or unstable mode.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/synthesis/flown_plant.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

/// The operating point of the analysis, in addition to the plan.
struct FlownLoopOptions {
  double height = 1.1;  ///< of the hover above the ground [m], > 0
  /// Delay from the law's output to the rotors [s], 0 to kMaxDelayPeriods control periods.
  double command_delay = 0;
  /// Simultaneous margins of several channels are never computed.
  MarginsEvidence evidence = MarginsEvidence::essential;
};

/// A flown loop with its poles and margins.
struct FlownLoop {
  FlownLoopOptions at;             ///< hover and evidence of the analysis
  double dt = 0;                   ///< control period [s]
  std::size_t period = 1;          ///< N: the sample clocks repeat after N control periods
  std::string estimator;           ///< PlannedFlight::estimator
  std::string sensors;             ///< PlannedFlight::sensors
  NamedMode mode;                  ///< mode with the largest |z|
  MarginsReport margins;           ///< at the law's outputs
  std::vector<Signal> drifts;      ///< FlownPlant::drifts
  std::vector<std::string> notes;  ///< FlownPlant::notes

  /// Whether every mode decays.
  [[nodiscard]] bool stable() const { return std::abs(mode.z) < 1; }
  /// Whether a mode grows faster than a neutral one.
  [[nodiscard]] bool grows() const { return decay() < -kNeutralGrowth; }
  /// Decay rate of the mode with the largest |z| [1/s]; negative if it grows.
  [[nodiscard]] double decay() const;
  /// Frequency of that mode [rad/s].
  [[nodiscard]] double frequency() const;
};

/// The options of the flown plant of a setup at the operating point of an analysis.
[[nodiscard]] FlownPlantOptions plant_options(const FlightSetup& setup,
                                              const FlownLoopOptions& options);

/// @throws InvalidInput  as flown_plant()
[[nodiscard]] FlownLoop flown_loop(const PlannedFlight& plan, const FlownLoopOptions& options = {});

/// Describes the mode with the largest |z|: "deviations double in 1.3 s, at 1.76 rad/s, mainly in py, v and roll".
[[nodiscard]] std::string describe(const FlownLoop& loop);

/// Names the changes that would stabilize an unstable loop: true states, sensors without delay,
/// rotors without lag, half the gains. One clause; it also states if none of them does.
/// @throws InvalidInput  as flown_loop()
[[nodiscard]] std::string what_helps(const PlannedFlight& plan, const FlownLoop& loop);

/// The notes of a report: states that no sensor observes, and the notes of the loop.
[[nodiscard]] std::vector<std::string> flown_notes(const FlownLoop& loop);

}  // namespace quadtune
