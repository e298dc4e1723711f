// SPDX-License-Identifier: Apache-2.0
#include "margins/crossover_margins.hpp"

#include <algorithm>
#include <cmath>

namespace quadtune::internal {

void set_margins_of_crossovers(LoopMargins& margins) {
  for (const PhaseCrossover& at : margins.phase_crossovers) {
    // If L is -1 up to rounding, there is no margin in either direction.
    const double factor = std::abs(at.gain_margin - 1) < 1e-9 ? 1 : at.gain_margin;
    if (factor >= 1) margins.gain_margin = std::min(margins.gain_margin, factor);
    if (factor <= 1) margins.gain_reduction = std::max(margins.gain_reduction, factor);
  }
  for (const GainCrossover& at : margins.gain_crossovers) {
    margins.delay_margin = std::min(margins.delay_margin, at.delay_margin);
    if (std::abs(at.phase_margin) >= std::abs(margins.phase_margin)) continue;
    margins.phase_margin = at.phase_margin;
    margins.crossover = at.w;
  }
  if (margins.stable) margins.phase_margin = std::abs(margins.phase_margin);
}

}  // namespace quadtune::internal
