// SPDX-License-Identifier: Apache-2.0
/// Makes text of unknown origin, such as a file name, safe for JSON and for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// The first character of a text, or its first byte if that does not start a valid character.
struct Utf8Character {
  char32_t code;       ///< the character, or the byte where `valid` is false
  std::size_t length;  ///< [bytes], 1 to 4
  bool valid;          ///< false if a sequence is truncated, overlong, a surrogate or too large
};

/// @param text  not empty
[[nodiscard]] Utf8Character first_character(std::string_view text);

/// `text` with every byte that is not UTF-8 replaced by a backslash, x and two hexadecimal digits,
/// so that the name can still be recognized (and passed to a shell as $'…').
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// Whether a terminal interprets a character instead of displaying it, or the character changes the
/// displayed order of text: control characters except line feed and tab, and bidirectional marks.
[[nodiscard]] bool is_control_or_mark(char32_t code);

/// valid_utf8() with each control character and bidirectional mark written as \x1b or \u202e.
[[nodiscard]] std::string visible_text(std::string_view text);

/// The first bytes of `text`, at most `most`, without splitting a character.
[[nodiscard]] std::string_view whole_characters(std::string_view text, std::size_t max);

}  // namespace quadtune::internal
