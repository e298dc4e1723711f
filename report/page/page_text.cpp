// SPDX-License-Identifier: Apache-2.0
#include "report/page/page_text.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/dump_json.hpp"
#include "quadtune/internal/utf8.hpp"

namespace quadtune::report {
namespace {

/// Appends the lowest `bytes` bytes of a number, least significant first.
void append_little_endian(std::vector<unsigned char>& out, std::uint64_t bits, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<unsigned char>(bits >> (8 * i)));
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string result;
  for (const char c : internal::valid_utf8(text)) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
          result += "\xEF\xBF\xBD";  // U+FFFD
        else
          result += c;
    }
  }
  return result;
}

std::string script_json(const nlohmann::json& value) {
  const std::string text = internal::dump_json(value, /*ascii=*/true);
  std::string result;
  result.reserve(text.size());
  // These three characters occur only in strings, where their escapes are equivalent.
  for (const char c : text) {
    if (c == '<')
      result += "\\u003c";
    else if (c == '>')
      result += "\\u003e";
    else if (c == '&')
      result += "\\u0026";
    else
      result += c;
  }
  return result;
}

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16 |
                                (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8 : 0) |
                                (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0);
    result += kDigits[group >> 18];
    result += kDigits[group >> 12 & 63];
    result += left > 1 ? kDigits[group >> 6 & 63] : '=';
    result += left > 2 ? kDigits[group & 63] : '=';
  }
  return result;
}

std::string float32_base64(const std::vector<double>& values) {
  std::vector<unsigned char> bytes;
  bytes.reserve(4 * values.size());
  for (const double value : values) {
    const bool fits = std::abs(value) <= std::numeric_limits<float>::max();  // false for NaN
    const float single = fits ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN();
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(single), 4);
  }
  return base64(bytes);
}

std::string float64_base64(const std::vector<double>& values) {
  std::vector<unsigned char> bytes;
  bytes.reserve(8 * values.size());
  for (const double value : values)
    append_little_endian(bytes, std::bit_cast<std::uint64_t>(value), 8);
  return base64(bytes);
}

std::string policy_hash(const std::string& text) {
  const std::string hex = sha256(text);
  std::vector<unsigned char> digest;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    digest.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return "'sha256-" + base64(digest) + "'";
}

}  // namespace quadtune::report
