// SPDX-License-Identifier: Apache-2.0
/// Firmware kinds, and parameters as they are stored in files.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

/// Firmware whose parameters quadtune reads and writes.
enum class FirmwareKind { px4, ardupilot, betaflight, crazyflie };

/// A version of a firmware, with the propellers if its scale depends on them.
struct Firmware {
  FirmwareKind kind = FirmwareKind::px4;  ///< which firmware
  std::string version;                    ///< one of firmware_versions()
  std::string setup;                      ///< one of firmware_setups(); empty if there are none

  friend bool operator==(const Firmware&, const Firmware&) = default;
};

/// A parameter with its value.
struct Parameter {
  std::string name;  ///< as the firmware spells it
  double value = 0;  ///< in the firmware's unit

  friend bool operator==(const Parameter&, const Parameter&) = default;
};

/// The parameters of a board. Missing parameters have the firmware's defaults.
struct StoredParameters {
  Firmware firmware;              ///< the version of the firmware
  std::vector<Parameter> values;  ///< parameters that are stored on the board

  friend bool operator==(const StoredParameters&, const StoredParameters&) = default;
};

}  // namespace quadtune
