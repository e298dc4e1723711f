// SPDX-License-Identifier: Apache-2.0
/// What a design, or its user, chooses of a firmware's parameters.
#pragma once

#include <string>

namespace quadtune {

/// For which state of a firmware a parameter file is. quadtune/exports/firmware.hpp lists what
/// exists.
struct FirmwareOptions {
  /// E.g. "1.15": names, meanings and scales change with it. Empty: the newest that is known.
  std::string version = {};
  /// Of a Crazyflie, whose firmware scales thrust by its propellers: "standard", "legacy",
  /// "thrust-kit" or "brushless". Empty: "standard".
  std::string setup = {};
  /// Whether the noise of the firmware's own estimator is written as well, from that of the
  /// design's general filter.
  bool filter_noise = false;

  friend bool operator==(const FirmwareOptions&, const FirmwareOptions&) = default;
};

}  // namespace quadtune
