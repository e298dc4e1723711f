// SPDX-License-Identifier: Apache-2.0
/// Cascades in TOML: the same in vehicle and design files.
#pragma once

#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

/// Keys of a table that read_cascade_gains() reads.
[[nodiscard]] std::vector<TomlKey> cascade_gain_keys();

/// dt_s and the tables x, y, pitch, roll, yaw, altitude with Kp, Ki and Kd, all six.
[[nodiscard]] CascadeGains read_cascade_gains(const TomlTable& table);

/// The table that asks for a cascade: dt_s and what docs/formats.md lists under [cascade.design].
/// @param dt  sample period [s], from the table around it
[[nodiscard]] CascadeSpecification read_cascade_specification(const TomlTable& table, double dt);

}  // namespace quadtune::internal
