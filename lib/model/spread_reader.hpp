// SPDX-License-Identifier: Apache-2.0
/// The table [spread] of vehicle files.
#pragma once

#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/model/vehicle_spread.hpp"

namespace quadtune::internal {

/// @throws InvalidInput  for an unknown key or a share outside 0 to kMaxSpread
[[nodiscard]] VehicleSpread read_spread(const TomlTable& table);

}  // namespace quadtune::internal
