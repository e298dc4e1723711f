// SPDX-License-Identifier: Apache-2.0
/// Reads the tables [[export]] of a design file.
#pragma once

#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

/// Reads all [[export]].
/// @param file    the whole file
/// @param design  read so far: the laws that can be exported
/// @throws InvalidInput  if the format of an export cannot hold the gains of the design
[[nodiscard]] std::vector<ExportRequest> read_exports(const TomlTable& file, const Design& design);

}  // namespace quadtune::internal
