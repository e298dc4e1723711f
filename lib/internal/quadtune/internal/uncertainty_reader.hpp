// SPDX-License-Identifier: Apache-2.0
/// Reads the uncertainty of campaign and requirement files: tables [[vary]] and [[correlation]]
/// (docs/formats.md).
#pragma once

#include <filesystem>

#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/simulation/campaign/uncertainty.hpp"

namespace quadtune::internal {

/// Reads [[vary]] and [[correlation]] at the top level of a file.
/// @param folder  base of relative paths of fitted models
/// @throws InvalidInput  "file:line: …"
/// @throws FileError     if a fitted model cannot be read
[[nodiscard]] Uncertainty read_uncertainty(const TomlTable& file,
                                           const std::filesystem::path& folder);

}  // namespace quadtune::internal
