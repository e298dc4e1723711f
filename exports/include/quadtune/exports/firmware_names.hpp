// SPDX-License-Identifier: Apache-2.0
/// Firmware kinds, and parameters as they are stored in files.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

enum class FirmwareKind { px4, ardupilot, betaflight, crazyflie };

/// A version of a firmware, with the propellers if its scale depends on them.
struct Firmware {
  FirmwareKind kind = FirmwareKind::px4;
  std::string version;  ///< one of firmware_versions()
  std::string setup;    ///< one of firmware_setups(); empty if there are none

  friend bool operator==(const Firmware&, const Firmware&) = default;
};

/// A parameter with its value.
struct Parameter {
  std::string name;
  double value = 0;

  friend bool operator==(const Parameter&, const Parameter&) = default;
};

/// The parameters of a board. Missing parameters have the firmware's defaults.
struct StoredParameters {
  Firmware firmware;
  std::vector<Parameter> values;

  friend bool operator==(const StoredParameters&, const StoredParameters&) = default;
};

}  // namespace quadtune
