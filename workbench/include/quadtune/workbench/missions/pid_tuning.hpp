// SPDX-License-Identifier: Apache-2.0
/// The gains of a PID cascade as parameters that are tuned over missions.
#pragma once

#include <string>

#include "quadtune/workbench/missions/mission_tuning.hpp"

namespace quadtune {

/// Each parameter is the logarithm of a factor on a gain.
/// @param vehicle   name or file
/// @param gains     initial gains: "designed", "published", or a gain file
/// @param separate  whether each loop has its own parameters; otherwise x and y share theirs, and
///                  so do pitch and roll
/// @throws OptionError, InvalidInput, FileError, NoSolution  as choose_law()
[[nodiscard]] MissionTuning pid_tuning(const std::string& vehicle, const std::string& gains,
                                       bool separate);

}  // namespace quadtune
