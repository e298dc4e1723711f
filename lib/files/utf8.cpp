// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/utf8.hpp"

#include <fmt/format.h>

namespace quadtune::internal {
namespace {

// The number of bytes that follow a first byte, and the smallest code that such a sequence may
// encode; -1 if the byte cannot be first. The smallest code rejects overlong forms, which would
// give one text several encodings.
struct Lead {
  int following;
  char32_t bits;
  char32_t min;
};
Lead lead_of(unsigned char byte) {
  if (byte < 0x80) return {0, byte, 0};
  if (byte >= 0xc0 && byte < 0xe0) return {1, byte & 0x1fU, 0x80};
  if (byte >= 0xe0 && byte < 0xf0) return {2, byte & 0x0fU, 0x800};
  if (byte >= 0xf0 && byte < 0xf8) return {3, byte & 0x07U, 0x10000};
  return {-1, 0, 0};
}

template <typename Append>
std::string rewritten(std::string_view text, const Append& append) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Utf8Character c = first_character(text);
    append(c, text.substr(0, c.length), result);
    text.remove_prefix(c.length);
  }
  return result;
}

void append_byte(char32_t byte, std::string& text) {
  text += fmt::format("\\x{:02x}", static_cast<unsigned>(byte));
}

}  // namespace

Utf8Character first_character(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const Utf8Character no_character{first, 1, false};
  const Lead lead = lead_of(first);
  if (lead.following < 0) return no_character;
  const std::size_t length = 1 + static_cast<std::size_t>(lead.following);
  if (text.size() < length) return no_character;
  char32_t code = lead.bits;
  for (std::size_t i = 1; i < length; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xc0U) != 0x80) return no_character;
    code = code << 6U | (byte & 0x3fU);
  }
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (code < lead.min || code > 0x10ffff || surrogate) return no_character;
  return {code, length, true};
}

std::string valid_utf8(std::string_view text) {
  return rewritten(text, [](const Utf8Character& c, std::string_view bytes, std::string& result) {
    if (c.valid)
      result += bytes;
    else
      append_byte(c.code, result);
  });
}

bool is_control_or_mark(char32_t code) {
  if (code < 0x20) return code != '\n' && code != '\t';
  return (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e || code == 0x200f ||
         (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

std::string visible_text(std::string_view text) {
  return rewritten(text, [](const Utf8Character& c, std::string_view bytes, std::string& result) {
    if (!c.valid || (c.code < 0x100 && is_control_or_mark(c.code)))
      append_byte(c.code, result);
    else if (is_control_or_mark(c.code))
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c.code));
    else
      result += bytes;
  });
}

std::string_view whole_characters(std::string_view text, std::size_t max) {
  if (text.size() <= max) return text;
  while (max > 0 && (static_cast<unsigned char>(text[max]) & 0xc0U) == 0x80) --max;
  return text.substr(0, max);
}

}  // namespace quadtune::internal
