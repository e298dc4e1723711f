// SPDX-License-Identifier: Apache-2.0
/// The weights of an LQR as numbers that are tuned over missions.
#pragma once

#include "quadtune/design.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"

namespace quadtune {

/// Each number is the logarithm of a factor on a weight; the weights of the first input stay, since
/// a gain determines its weights up to a factor.
/// @param plant     the vehicle about a hover
/// @param design    the problem, sampled, with the weights where the search begins
/// @param standard  whether Bryson's rule replaces these weights; for all states of "ned"
/// @param separate  whether each weight has a number of its own; otherwise axes that are alike, and
///                  all rotors, share theirs
/// @throws InvalidInput  for a problem that DiagonalLqr refuses
[[nodiscard]] MissionTuning lqr_tuning(LinearVehicle plant, const LqrDesign& design, bool standard,
                                       bool separate);

}  // namespace quadtune
