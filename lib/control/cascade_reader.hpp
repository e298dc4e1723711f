// SPDX-License-Identifier: Apache-2.0
/// Reads cascades from TOML, in vehicle and design files.
#pragma once

#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/loop_limits.hpp"

namespace quadtune::internal {

/// The control periods that dt_s of a law may have.
inline constexpr Range kControlPeriods = {kMinControlPeriod, Range::Bound::closed,
                                          kMaxControlPeriod, Range::Bound::closed};

/// The keys of a table that read_cascade_gains() reads.
[[nodiscard]] std::vector<TomlKey> cascade_gain_keys();

/// Reads dt_s and all six tables x, y, pitch, roll, yaw, altitude with Kp, Ki, Kd,
/// rate_lead_s and rate_filter_s.
[[nodiscard]] CascadeGains read_cascade_gains(const TomlTable& table);

/// Reads the requirements on a cascade: the keys of [cascade.design] in docs/formats.md.
/// @param dt  sample period [s], from the enclosing table
[[nodiscard]] CascadeSpecification read_cascade_specification(const TomlTable& table, double dt);

}  // namespace quadtune::internal
