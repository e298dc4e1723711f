// SPDX-License-Identifier: Apache-2.0
/// Reads files whole, with a limit.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// The bytes of a file; "-" is standard input.
/// @throws FileError     if it cannot be read, with the system's reason.
/// @throws InvalidInput  if it has more than `limit` bytes or holds a zero byte (it is not text).
[[nodiscard]] std::string read_text_file(const std::string& path, std::size_t limit);

/// The same for a file that may hold any bytes, a zero byte included.
/// @throws FileError, InvalidInput  as read_text_file().
[[nodiscard]] std::string read_file(const std::string& path, std::size_t limit);

/// The two checks of read_text_file() on bytes that are already here.
/// @throws InvalidInput  naming `origin`.
void require_text(std::string_view text, const std::string& origin, std::size_t limit);

/// `text` fit for a one-line message: what is not printable ASCII becomes '?', and what is longer
/// than `longest` bytes is cut and ends in "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 60);

}  // namespace quadtune::internal
