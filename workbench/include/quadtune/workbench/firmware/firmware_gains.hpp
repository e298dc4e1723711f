// SPDX-License-Identifier: Apache-2.0
/// Gains for the flown plant that also satisfy the bounds in the rotation loops of a firmware.
#pragma once

#include <vector>

#include "quadtune/exports/firmware.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"

namespace quadtune {

/// The structure of the cascade that a firmware flies: pid for a Crazyflie, otherwise p_pi.
[[nodiscard]] CascadeStructure structure_of(FirmwareKind kind);

/// Computes flown_gains() whose roll, pitch and yaw loops also satisfy `options.bounds.Ms` as the
/// firmwares fly them: with the firmware's filters at their defaults, its delay and the motor lag
/// (firmware_turns()). A group that does not is designed again with a smaller bound, at most eight
/// times; what is still exceeded then is reported in the notes.
/// @param vehicle    valid
/// @param firmwares  any number; the structure is p_pi if one of them needs it
/// @param options    as for flown_gains(); a p_pi of the firmwares replaces the structure. Without
///                   `rate_lead`, roll and pitch get a lead of half the motor lag if every firmware
///                   is PX4 or ArduPilot. With a lead, a `rate_filter` of 0 becomes that of the
///                   firmwares, or without a firmware a quarter of the lead.
/// @throws InvalidInput, OptionError, NoSolution  as flown_gains()
/// @throws InvalidInput  as firmware_parameters(), e.g. if a firmware cannot mix the rotors
[[nodiscard]] FlownGains firmware_gains(const Vehicle& vehicle,
                                        const std::vector<Firmware>& firmwares,
                                        FlownGainsOptions options);

}  // namespace quadtune
