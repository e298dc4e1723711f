// SPDX-License-Identifier: Apache-2.0
/// Reads whole files up to a size limit.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// The bytes of a file, or of standard input if the path is "-".
/// @throws FileError     if it cannot be read, with the operating system's reason.
/// @throws InvalidInput  if it has more than `limit` bytes or contains a zero byte (is not text).
[[nodiscard]] std::string read_text_file(const std::string& path, std::size_t limit);

/// The same for a file that may contain any bytes, including zero bytes.
/// @throws FileError, InvalidInput  as read_text_file().
[[nodiscard]] std::string read_file(const std::string& path, std::size_t limit);

/// Applies the two checks of read_text_file() to bytes in memory.
/// @throws InvalidInput  with `origin` as the place.
void require_text(std::string_view text, const std::string& origin, std::size_t limit);

/// `text` prepared for a one-line message: bytes that are not printable ASCII become '?', and a
/// text longer than `longest` bytes is truncated and ends in "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 60);

}  // namespace quadtune::internal
