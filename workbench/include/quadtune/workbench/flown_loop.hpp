// SPDX-License-Identifier: Apache-2.0
/// The loop of a planned flight as it flies near a hover: whether it holds, by how much, and which
/// motion is the first to grow.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/synthesis/flown_plant.hpp"
#include "quadtune/workbench/flight_plan.hpp"
#include "quadtune/workbench/margins_report.hpp"

namespace quadtune {

/// Where the loop is looked at, beside what the plan says.
struct FlownLoopOptions {
  double height = 1.1;       ///< of the hover above the ground [m], > 0
  double command_delay = 0;  ///< from the law's output to the rotors [s], 0 … kMostDelayPeriods control periods
  MarginsEvidence evidence = MarginsEvidence::essential;  ///< all at once is never computed
};

struct FlownLoop {
  FlownLoopOptions at;
  double dt = 0;                   ///< control period [s]
  std::size_t period = 1;          ///< after how many of these the sensors' clocks repeat
  std::string estimator;           ///< PlannedFlight::estimator
  std::string sensors;             ///< PlannedFlight::sensors
  NamedMode mode;                  ///< of the largest |z|
  MarginsReport margins;           ///< at the law's outputs
  std::vector<Signal> drifts;      ///< FlownPlant::drifts
  std::vector<std::string> notes;  ///< FlownPlant::notes

  /// Whether every motion about the hover decays.
  [[nodiscard]] bool stable() const { return std::abs(mode.z) < 1; }
  /// Whether some motion grows: by more than a thousandth in ten seconds, so that what merely
  /// stands (a belief that no sensor corrects, |z| = 1) does not count.
  [[nodiscard]] bool grows() const { return decay() < -1e-4; }
  /// How fast the mode of the largest |z| decays, > 0, or grows [1/s].
  [[nodiscard]] double decay() const;
  /// Its frequency [rad/s].
  [[nodiscard]] double frequency() const;
};

/// @throws InvalidInput  as flown_plant()
[[nodiscard]] FlownLoop flown_loop(const PlannedFlight& plan, const FlownLoopOptions& options = {});

/// "py, believed v and roll: grows by half in 1.3 s, 1.76 rad/s": the mode of the largest |z|.
[[nodiscard]] std::string in_words(const FlownLoop& loop);

/// Why a loop grows, by what makes it stable: true states, ideal sensors, rotors without lag, half
/// the gains. One sentence; where none of these does, it says so.
/// @throws InvalidInput  as flown_loop()
[[nodiscard]] std::string what_helps(const PlannedFlight& plan, const FlownLoop& loop);

/// What a reader must be told: motion that no sensor sees, and the notes.
[[nodiscard]] std::vector<std::string> flown_notes(const FlownLoop& loop);

}  // namespace quadtune
