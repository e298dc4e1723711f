// SPDX-License-Identifier: Apache-2.0
/// What surrounds the gains in a firmware's loops: its filters, and how often it computes them.
/// Sources: docs/bibliography.md, "Firmware".
#pragma once

#include <vector>

#include "quadtune/exports/firmware.hpp"

namespace quadtune::internal {

/// A Butterworth filter of first or second order.
struct LowPass {
  int order = 1;
  double cutoff = 0;  ///< [Hz], > 0
};

/// Filters in series; none: the signal passes as it is.
using LowPasses = std::vector<LowPass>;

/// The filters of one loop.
struct LoopFilters {
  LowPasses rate;        ///< of the measured rate, for P, I and D
  LowPasses derivative;  ///< of D, in addition to those of the signal that D differentiates
  LowPasses error;       ///< of the error of the rate, for P and I, and for D where it acts on it
  LowPasses target;      ///< of the rate that the outer loop asks for
  LowPasses output;
};

[[nodiscard]] LoopFilters loop_filters(const Firmware& firmware, CascadeAxis axis,
                                       const ParameterValues& value);

/// How often a firmware computes its loops [Hz].
struct LoopRates {
  double rate = 0;      ///< of the body rates
  double attitude = 0;  ///< of the angles
  double position = 0;  ///< of position and velocity
};

[[nodiscard]] LoopRates loop_rates(const Firmware& firmware, const ParameterValues& value);

}  // namespace quadtune::internal
