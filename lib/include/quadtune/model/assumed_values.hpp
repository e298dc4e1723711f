// SPDX-License-Identifier: Apache-2.0
/// What a vehicle's file does not say, and what is taken in its place.
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// One key that the file does not have.
struct AssumedValue {
  std::string key;    ///< as in the file with its table, e.g. "rotor.lag_s"
  std::string value;  ///< what is taken, with its unit, e.g. "0 s: speeds follow at once"
};

/// Every key with a default that acts and that the vehicle's file leaves out, in the order of
/// docs/formats.md. Of keys of the rotors those that no rotor has.
/// @return  none for a vehicle that was made in memory
[[nodiscard]] std::vector<AssumedValue> assumed_values(const Vehicle& vehicle);

}  // namespace quadtune
