// SPDX-License-Identifier: Apache-2.0
/// Reads a file of an export.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::exports {

/// Maximum size of an exported file [byte].
inline constexpr std::size_t kExportLimit = std::size_t{16} << 20;

/// @throws FileError  for a pipe, a socket or a device: a program that loads its gains would block
///                    there, or read other data
inline void require_regular(const std::filesystem::path& path) {
  std::error_code unreadable;  // the read reports the reason
  const std::filesystem::file_type type = std::filesystem::status(path, unreadable).type();
  if (type == std::filesystem::file_type::fifo || type == std::filesystem::file_type::socket)
    throw FileError(path.string(), "is a pipe or a socket, expected a regular file");
  if (type == std::filesystem::file_type::character || type == std::filesystem::file_type::block)
    throw FileError(path.string(), "is a device, expected a regular file");
}

/// @throws FileError     if it cannot be read, with the system's reason; as require_regular()
/// @throws InvalidInput  if it is not text or exceeds the maximum size
inline std::string export_text(const std::filesystem::path& path) {
  require_regular(path);
  return internal::read_text_file(path.string(), kExportLimit);
}

/// The same for a file that may be binary.
inline std::string export_bytes(const std::filesystem::path& path) {
  require_regular(path);
  return internal::read_file(path.string(), kExportLimit);
}

/// The first character that is not blank, or '\0'; it identifies the format of a file with an
/// arbitrary name.
inline char first_mark(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == std::string::npos ? '\0' : text[first];
}

inline bool is_json(const std::filesystem::path& file, const std::string& text) {
  return first_mark(text) == '{' || file.extension() == ".json";
}

}  // namespace quadtune::exports
