// SPDX-License-Identifier: Apache-2.0
/// Weights of an LQR problem over missions.
#pragma once

#include "arguments/lqr_arguments.hpp"
#include "missions/mission_tuning.hpp"

namespace quadtune::cli {

/// Searches in the logarithms of the weights, so that every candidate is a stabilizing design.
/// @param problem  Q and R empty: weights by Bryson's rule, as `fly --controller state-feedback`
/// @param separate whether x and y, roll and pitch have weights each for itself
void run_lqr_missions(const LqrArguments& problem, const MissionTuningArguments& arguments,
                      bool separate, Context& context);

}  // namespace quadtune::cli
