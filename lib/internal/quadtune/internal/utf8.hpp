// SPDX-License-Identifier: Apache-2.0
/// Text of unknown origin, such as the name of a file, made fit for JSON and for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// What a text begins with: a character, or a byte that begins none.
struct Utf8Character {
  char32_t code;       ///< the character, or the byte where `valid` is false
  std::size_t length;  ///< [bytes], 1 to 4
  bool valid;          ///< false where a sequence is cut short, overlong, a surrogate or too large
};

/// @param text  Not empty.
[[nodiscard]] Utf8Character first_character(std::string_view text);

/// `text` with every byte that is not UTF-8 as a backslash, x and two hexadecimal digits, so that
/// the name can still be recognized (and given to a shell as $'…').
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// Whether a terminal obeys a character instead of showing it, or hides behind it in which order
/// text is read: control characters but line feed and tab, and the marks of writing direction.
[[nodiscard]] bool is_control_or_mark(char32_t code);

/// valid_utf8(), with each control character and mark of writing direction as \x1b or \u202e.
[[nodiscard]] std::string visible_text(std::string_view text);

/// The first bytes of `text`, at most `most`, without a character cut in two.
[[nodiscard]] std::string_view whole_characters(std::string_view text, std::size_t most);

}  // namespace quadtune::internal
