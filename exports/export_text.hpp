// SPDX-License-Identifier: Apache-2.0
/// Reads the text of a file that quadtune exports.
#pragma once

#include <filesystem>
#include <string>

#include "quadtune/internal/text_file.hpp"

namespace quadtune::exports {

/// @throws FileError     if it cannot be read, with the system's reason.
/// @throws InvalidInput  if it is no text or larger than any export.
inline std::string export_text(const std::filesystem::path& path) {
  return internal::read_text_file(path.string(), std::size_t{16} << 20);
}

}  // namespace quadtune::exports
