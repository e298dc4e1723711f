// SPDX-License-Identifier: Apache-2.0
/// The weights of an LQR as parameters that are tuned over missions.
#pragma once

#include "quadtune/design.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"

namespace quadtune {

/// Each parameter is the logarithm of a factor on a weight. The weights of the first input are
/// fixed, because a gain determines its weights only up to a common factor.
/// @param plant     the vehicle at hover
/// @param design    the sampled problem, with the initial weights
/// @param standard  whether Bryson's rule replaces these weights; requires all states of "ned"
/// @param separate  whether each weight has its own parameter; otherwise similar axes, and all
///                  rotors, share theirs
/// @throws InvalidInput  if DiagonalLqr rejects the problem
[[nodiscard]] MissionTuning lqr_tuning(LinearVehicle plant, const LqrDesign& design, bool standard,
                                       bool separate);

}  // namespace quadtune
