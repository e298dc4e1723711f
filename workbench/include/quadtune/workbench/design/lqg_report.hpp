// SPDX-License-Identifier: Apache-2.0
/// State feedback together with its filter: the deviations that sensor noise causes, and the
/// margins that a faster filter recovers. Theory: docs/theory.md, "Predicted deviations".
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/flight/predicted_rms.hpp"

namespace quadtune {

/// The filter with another noise of its accelerometer and gyroscope.
struct Recovery {
  double factor = 1;       ///< on their densities, ≥ 1
  double share = 0;        ///< smallest share of FlownMargins at the law's outputs; 0: unstable
  double noise = 0;        ///< largest ratio of a command's rms to that with factor 1
  bool affordable = true;  ///< whether `noise` is within the budget
};

struct LqgOptions {
  FlownLqiOptions design;
  double time = 60;  ///< of the prediction [s], see predicted_rms()
  /// Whether the filter's noise is raised for the sake of the margins (loop transfer recovery).
  bool recover = false;
  double noise_budget = 1.5;  ///< most Recovery::noise, ≥ 1
};

struct LqgReport {
  LqiReport lqi;               ///< with the filter that was chosen
  MarginsReport at_estimates;  ///< of the loop cut where the law reads its estimates
  PredictedRms rms;
  std::vector<Recovery> recoveries;   ///< that were tried, factor 1 first; empty unless asked
  double recovery = 1;                ///< the factor that was chosen
  std::vector<std::string> messages;  ///< "note: …" and "warning: …" for the user
};

/// Designs by lqi_report(), with the filter that flies: the steady gains of the general filter.
/// @throws OptionError   for an option out of range, or a recovery without the general filter
/// @throws InvalidInput, NoSolution  as lqi_report()
[[nodiscard]] LqgReport lqg_report(const Vehicle& vehicle, const LqgOptions& options,
                                   const FlightOptions& flight = {},
                                   const FlownLoopOptions& at = {});

}  // namespace quadtune
