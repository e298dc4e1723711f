// SPDX-License-Identifier: Apache-2.0
/// Values that a vehicle file leaves out, and the defaults used instead.
#pragma once

#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// One key that is missing in the file.
struct AssumedValue {
  std::string key;    ///< name with its table, e.g. "rotor.lag_s"
  std::string value;  ///< the default with its unit, e.g. "0 s: speeds follow at once"
};

/// All missing keys whose defaults affect the model, in the order of docs/formats.md. A key of the
/// rotors is listed only if no rotor has it.
/// @return  empty for a vehicle that was not read from a file
[[nodiscard]] std::vector<AssumedValue> assumed_values(const Vehicle& vehicle);

}  // namespace quadtune
