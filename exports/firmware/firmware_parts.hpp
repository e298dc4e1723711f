// SPDX-License-Identifier: Apache-2.0
/// Helpers shared by the files of this folder.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/exports/firmware.hpp"

namespace quadtune::exports {

/// Whether a firmware has `version`, one of firmware_versions(), or a newer one.
[[nodiscard]] inline bool is_from(const Firmware& firmware, const std::string& version) {
  const std::vector<std::string> newest_first = firmware_versions(firmware.kind);
  return std::find(newest_first.begin(), newest_first.end(), firmware.version) <=
         std::find(newest_first.begin(), newest_first.end(), version);
}

/// Why a parameter cannot have a value, as the end of a sentence that begins with its name; empty
/// if it can.
[[nodiscard]] std::string why_no_value(const ParameterFacts& facts, double value);

/// Gravity that ArduPilot and PX4 assume [m/s²].
inline constexpr double kStandardGravity = 9.80665;

/// The parameter names of a rotation loop.
struct TurnWords {
  CascadeAxis axis;
  std::size_t index;  ///< in FirmwareScale::torque
  const char* px4;
  const char* ardupilot;
  const char* small;
};
inline constexpr TurnWords kTurns[] = {{CascadeAxis::roll, 0, "ROLL", "RLL", "roll"},
                                       {CascadeAxis::pitch, 1, "PITCH", "PIT", "pitch"},
                                       {CascadeAxis::yaw, 2, "YAW", "YAW", "yaw"}};

/// The names of the position and height loops of ArduPilot by version.
struct ArdupilotNames {
  std::string horizontal_position, horizontal_velocity, vertical_position, vertical_velocity,
      acceleration;
};
[[nodiscard]] inline ArdupilotNames ardupilot_names(const Firmware& firmware) {
  if (is_from(firmware, "4.7"))
    return {"PSC_NE_POS_", "PSC_NE_VEL_", "PSC_D_POS_", "PSC_D_VEL_", "PSC_D_ACC_"};
  return {"PSC_POSXY_", "PSC_VELXY_", "PSC_POSZ_", "PSC_VELZ_", "PSC_ACCZ_"};
}

/// Output of Betaflight per unit of a gain and SI unit; the integral of yaw counts 2.5 times.
inline constexpr double kDegrees = 180 / 3.14159265358979323846;
inline constexpr double kBetaflightP = 0.032029 * kDegrees;
inline constexpr double kBetaflightI = 0.244381 * kDegrees;
inline constexpr double kBetaflightD = 0.000529 * kDegrees;
inline constexpr double kBetaflightYaw = 2.5;

/// Output scale of Crazyflie's vertical velocity loop: 16-bit thrust per unit of its output.
inline constexpr double kCrazyflieThrust = 1000;

}  // namespace quadtune::exports
