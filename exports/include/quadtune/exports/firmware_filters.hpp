// SPDX-License-Identifier: Apache-2.0
/// Filters and sample rates of a firmware's loops. Sources: docs/bibliography.md, "Firmware".
#pragma once

#include <vector>

#include "quadtune/exports/firmware.hpp"

namespace quadtune::internal {

/// A Butterworth filter of first or second order.
struct LowPass {
  int order = 1;
  double cutoff = 0;  ///< [Hz], > 0
};

/// Filters in series; empty: the signal is not filtered.
using LowPasses = std::vector<LowPass>;

/// The filters of one loop.
struct LoopFilters {
  LowPasses rate;        ///< on the measured rate, for P, I and D
  LowPasses derivative;  ///< on D, in addition to those of its input
  LowPasses error;       ///< on the error of the rate, for P, I, and D if it acts on the error
  LowPasses target;      ///< on the rate set point from the outer loop
  LowPasses output;
};

[[nodiscard]] LoopFilters loop_filters(const Firmware& firmware, CascadeAxis axis,
                                       const ParameterValues& value);

/// Sum of the time constants of the filters of D, in addition to those of its input [s].
[[nodiscard]] double derivative_time(const Firmware& firmware, CascadeAxis axis,
                                     const ParameterValues& value);

/// Whether a loop with a lead of the rate can be represented by a gain on the angle before a PID
/// controller whose D acts on the error of the rate: the polynomial lead A³ - A² + a A - b of its
/// outer gain A falls to 0 again. Theory: "Cascades of autopilots".
/// @param a, b  |Kp/Kd| and |Ki/Kd| of the loop
/// @param lead  [s], > 0
[[nodiscard]] bool exists_with_error_lead(double a, double b, double lead);

/// Sample rates of a firmware's loops [Hz].
struct LoopRates {
  double rate = 0;      ///< body rate loops
  double attitude = 0;  ///< angle loops
  double position = 0;  ///< position and velocity loops
};

[[nodiscard]] LoopRates loop_rates(const Firmware& firmware, const ParameterValues& value);

}  // namespace quadtune::internal
