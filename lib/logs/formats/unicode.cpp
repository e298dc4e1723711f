// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/unicode.hpp"

#include <cstddef>

#include "quadtune/internal/utf8.hpp"

namespace quadtune::internal {
namespace {

constexpr char32_t kFirstPair = 0x10000;  // first character that needs two UTF-16 units

bool is_surrogate(char32_t c) { return c >= 0xd800 && c < 0xe000; }

}  // namespace

std::optional<std::u16string> utf16_of(std::string_view text) {
  std::u16string units;
  while (!text.empty()) {
    const Utf8Character character = first_character(text);
    if (!character.valid) return std::nullopt;
    text.remove_prefix(character.length);
    const char32_t c = character.code;
    if (c < kFirstPair) {
      units += static_cast<char16_t>(c);
    } else {
      units += static_cast<char16_t>(0xd800U + ((c - kFirstPair) >> 10U));
      units += static_cast<char16_t>(0xdc00U + ((c - kFirstPair) & 0x3ffU));
    }
  }
  return units;
}

std::optional<std::string> utf8_of(std::u16string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char32_t c = text[i];
    if (is_surrogate(c)) {
      const bool pair =
          c < 0xdc00 && i + 1 < text.size() && text[i + 1] >= 0xdc00 && text[i + 1] < 0xe000;
      if (!pair) return std::nullopt;
      c = kFirstPair + ((c - 0xd800U) << 10U) + (text[++i] - 0xdc00U);
    }
    const auto follow = [&](unsigned shift) {
      bytes += static_cast<char>(0x80U | (c >> shift & 0x3fU));
    };
    if (c < 0x80) {
      bytes += static_cast<char>(c);
    } else if (c < 0x800) {
      bytes += static_cast<char>(0xc0U | c >> 6U);
      follow(0);
    } else if (c < kFirstPair) {
      bytes += static_cast<char>(0xe0U | c >> 12U);
      follow(6);
      follow(0);
    } else {
      bytes += static_cast<char>(0xf0U | c >> 18U);
      follow(12);
      follow(6);
      follow(0);
    }
  }
  return bytes;
}

}  // namespace quadtune::internal
