// SPDX-License-Identifier: Apache-2.0
/// The margins that follow from the crossovers of a loop.
#pragma once

#include "quadtune/synthesis/margins.hpp"

namespace quadtune::internal {

/// Sets the gain, phase and delay margins of a loop and its crossover from its crossovers: each
/// margin is the smallest one. The phase margin of a stable loop is a magnitude, lag or lead; the
/// sign is in gain_crossovers.
/// @param margins  with `stable`, `gain_crossovers` and `phase_crossovers`
void set_margins_of_crossovers(LoopMargins& margins);

}  // namespace quadtune::internal
