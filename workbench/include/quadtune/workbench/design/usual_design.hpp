// SPDX-License-Identifier: Apache-2.0
/// The design of a vehicle for which there is no design file.
#pragma once

#include <string>
#include <vector>

#include "quadtune/design.hpp"

namespace quadtune {

/// The PID cascade that `quadtune pid V` designs every 5 ms, to be flown with the vehicle's own
/// sensors in the missions hover, step-north and take-off-and-land. If the motor lag is at least
/// 20 ms and the loops are designed on the flown plant, roll and pitch have a lead of half the lag
/// (FlownGainsOptions::rate_lead).
///
/// If a firmware is among the exports, the cascade has the structure of that firmware, and its
/// filters and delay are taken into account; its lead is that of firmware_gains().
/// @param vehicle  a built-in vehicle's name or a vehicle file
/// @param to       export formats; empty: JSON, and a flight program in C
/// @return         with the text of a design file that asks for the same
/// @throws InvalidInput, FileError  as load_vehicle()
/// @throws OptionError  "to" if a format is unknown, requested twice or cannot hold a cascade
[[nodiscard]] Design usual_design(const std::string& vehicle,
                                  const std::vector<std::string>& to = {});

/// Whether a word names a vehicle rather than a design file: a vehicle file, or the name of a
/// built-in vehicle, if no file has this name.
[[nodiscard]] bool names_vehicle(const std::string& word);

}  // namespace quadtune
