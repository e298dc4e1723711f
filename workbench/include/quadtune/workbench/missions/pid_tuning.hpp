// SPDX-License-Identifier: Apache-2.0
/// The gains of a PID cascade as numbers that are tuned over missions.
#pragma once

#include <string>

#include "quadtune/workbench/missions/mission_tuning.hpp"

namespace quadtune {

/// Each number is the logarithm of a factor on a gain.
/// @param vehicle   name or file
/// @param gains     where the search begins: "designed", "published", or a file of gains
/// @param separate  whether each loop has numbers of its own; otherwise x and y, and pitch and
/// roll,
///                  share theirs
/// @throws OptionError, InvalidInput, FileError, NoSolution  as choose_law()
[[nodiscard]] MissionTuning pid_tuning(const std::string& vehicle, const std::string& gains,
                                       bool separate);

}  // namespace quadtune
