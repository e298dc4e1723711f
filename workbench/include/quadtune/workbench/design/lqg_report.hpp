// SPDX-License-Identifier: Apache-2.0
/// State feedback together with its filter: the deviations that sensor noise causes, and the
/// margins that are recovered with a faster filter. Theory: docs/theory.md, "Predicted deviations".
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/flight/predicted_rms.hpp"

namespace quadtune {

/// The filter with a modified noise density of its accelerometer and gyroscope.
struct Recovery {
  double factor = 1;       ///< factor on the noise densities, ≥ 1
  double share = 0;        ///< smallest share of FlownMargins at the law's outputs; 0: unstable
  double noise = 0;        ///< largest ratio of a command's rms to its rms with factor 1
  bool affordable = true;  ///< whether `noise` is within the budget
};

/// Options of an LQG design.
struct LqgOptions {
  FlownLqiOptions design;  ///< of the state feedback
  double time = 60;        ///< of the prediction [s], see predicted_rms()
  /// Whether the filter's noise is increased to improve the margins (loop transfer recovery).
  bool recover = false;
  double noise_budget = 1.5;  ///< maximum of Recovery::noise, ≥ 1
};

/// An LQG regulator with its evidence.
struct LqgReport {
  LqiReport lqi;                      ///< with the chosen filter
  MarginsReport at_estimates;         ///< of the loop cut at the estimates that the law reads
  PredictedRms rms;                   ///< of states, estimates and commands
  std::vector<Recovery> recoveries;   ///< all that were tried, factor 1 first; empty unless
                                      ///< requested
  double recovery = 1;                ///< the chosen factor
  std::vector<std::string> messages;  ///< "note: …" and "warning: …" for the user
};

/// Designs with lqi_report(), with the flown filter: the steady gains of the general filter.
/// @throws OptionError   if an option is out of range, or recovery is requested without the general
///                       filter
/// @throws InvalidInput, NoSolution  as lqi_report()
[[nodiscard]] LqgReport lqg_report(const Vehicle& vehicle, const LqgOptions& options,
                                   const FlightOptions& flight = {},
                                   const FlownLoopOptions& at = {});

}  // namespace quadtune
