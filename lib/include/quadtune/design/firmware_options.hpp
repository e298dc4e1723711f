// SPDX-License-Identifier: Apache-2.0
/// Options of an export of firmware parameters, set by a design file or on the command line.
#pragma once

#include <string>

namespace quadtune {

/// The firmware state for which a parameter file is written. quadtune/exports/firmware.hpp lists
/// the supported ones.
struct FirmwareOptions {
  /// E.g. "1.15": parameter names, meanings and scales depend on it. Empty: the default version of
  /// firmware(), which is not always the newest supported one: "1.16" for PX4, "4.6" for ArduPilot.
  std::string version = {};
  /// For a Crazyflie, whose firmware scales thrust by its propellers: "standard", "legacy",
  /// "thrust-kit" or "brushless". Empty: "standard".
  std::string setup = {};
  /// Whether to write noise parameters for the firmware's own estimator as well, from the noise of
  /// the design's general filter.
  bool filter_noise = false;

  friend bool operator==(const FirmwareOptions&, const FirmwareOptions&) = default;
};

}  // namespace quadtune
