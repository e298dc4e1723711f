// SPDX-License-Identifier: Apache-2.0
#include "logs/unicode.hpp"

#include <cstddef>
#include <cstdint>

namespace quadtune::internal {
namespace {

constexpr char32_t kFirstPair = 0x10000;  // from here on UTF-16 needs two units

bool is_surrogate(char32_t c) { return c >= 0xd800 && c < 0xe000; }

// How many bytes follow a first byte, and the least that so many may stand for; -1 for no first
// byte. The least refuses overlong forms, with which one text would have several spellings.
struct Lead {
  int following;
  char32_t bits;
  char32_t least;
};
Lead lead_of(unsigned char byte) {
  if (byte < 0x80) return {0, byte, 0};
  if (byte >= 0xc0 && byte < 0xe0) return {1, byte & 0x1fU, 0x80};
  if (byte >= 0xe0 && byte < 0xf0) return {2, byte & 0x0fU, 0x800};
  if (byte >= 0xf0 && byte < 0xf8) return {3, byte & 0x07U, kFirstPair};
  return {-1, 0, 0};
}

}  // namespace

std::optional<std::u16string> utf16_of(std::string_view text) {
  std::u16string units;
  for (std::size_t i = 0; i < text.size();) {
    const Lead lead = lead_of(static_cast<unsigned char>(text[i++]));
    if (lead.following < 0) return std::nullopt;
    char32_t c = lead.bits;
    for (int k = 0; k < lead.following; ++k) {
      if (i == text.size()) return std::nullopt;
      const auto byte = static_cast<unsigned char>(text[i++]);
      if ((byte & 0xc0U) != 0x80) return std::nullopt;
      c = c << 6U | (byte & 0x3fU);
    }
    if (c < lead.least || c > 0x10ffff || is_surrogate(c)) return std::nullopt;
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
