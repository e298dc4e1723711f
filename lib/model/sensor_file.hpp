// SPDX-License-Identifier: Apache-2.0
/// Reads [sensors] and [battery] of a vehicle file.
#pragma once

#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/model/battery.hpp"
#include "quadtune/model/sensors.hpp"

namespace quadtune::internal {

/// The sensors that the table lists; the others are empty.
[[nodiscard]] Sensors read_sensors(const TomlTable& table);
[[nodiscard]] Battery read_battery(const TomlTable& table);

}  // namespace quadtune::internal
