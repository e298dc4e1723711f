// SPDX-License-Identifier: Apache-2.0
/// Reads the tables [lqr] and [published] of a design file.
#pragma once

#include <filesystem>
#include <optional>

#include "quadtune/design.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

/// Whether the plant of [lqr] is "flown" and not "ideal".
[[nodiscard]] bool on_flown_plant(const TomlTable& table);

/// Reads [lqr] with plant = "ideal".
/// @param vehicle  its rotors are the inputs
/// @param folder   that of the design file, where the file of a convention is searched
[[nodiscard]] LqrDesign read_lqr(const TomlTable& table, const Vehicle& vehicle,
                                 const std::filesystem::path& folder);

/// Reads [lqr] with plant = "flown".
[[nodiscard]] LqiDesign read_lqi(const TomlTable& table, const std::filesystem::path& folder);

/// Reads [published].
/// @param lqr  the design whose gains are compared with the published ones
/// @throws InvalidInput  if there is none, or the shapes do not match its states and inputs
[[nodiscard]] PublishedGains read_published(const TomlTable& table,
                                            const std::optional<LqrDesign>& lqr);

}  // namespace quadtune::internal
