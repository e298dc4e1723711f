// SPDX-License-Identifier: Apache-2.0
#include "margins/crossover_margins.hpp"

#include <algorithm>
#include <cmath>

namespace quadtune::internal {

void set_margins_of_crossovers(LoopMargins& margins) {
  for (const PhaseCrossover& at : margins.phase_crossovers) {
    if (at.gain_margin > 1) margins.gain_margin = std::min(margins.gain_margin, at.gain_margin);
    if (at.gain_margin < 1)
      margins.gain_reduction = std::max(margins.gain_reduction, at.gain_margin);
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
