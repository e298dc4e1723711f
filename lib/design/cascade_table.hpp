// SPDX-License-Identifier: Apache-2.0
/// Reads the table [cascade] of a design file.
#pragma once

#include "quadtune/design.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

/// Reads [cascade]: gains, or with [cascade.design] what is required of them.
[[nodiscard]] CascadeDesign read_cascade(const TomlTable& table);

}  // namespace quadtune::internal
