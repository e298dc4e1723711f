// SPDX-License-Identifier: Apache-2.0
/// Uncertainty as campaign and requirement files write it: tables [[vary]] and [[correlation]]
/// (docs/formats.md).
#pragma once

#include <filesystem>

#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/simulation/uncertainty.hpp"

namespace quadtune::internal {

/// Reads [[vary]] and [[correlation]] of a file's top.
/// @param folder  where files of fitted models that it names lie
/// @throws InvalidInput  "file:line: …"
/// @throws FileError     for a fitted model that cannot be read
[[nodiscard]] Uncertainty read_uncertainty(const TomlTable& file,
                                           const std::filesystem::path& folder);

}  // namespace quadtune::internal
