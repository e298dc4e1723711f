// SPDX-License-Identifier: Apache-2.0
#include "report/text/error_line.hpp"

#include <algorithm>
#include <string_view>

#include "quadtune/internal/utf8.hpp"

namespace quadtune::report {
namespace {

/// Removes the middle of `text`, so that at most `most` bytes remain.
std::string without_middle(std::string_view text, std::size_t max) {
  constexpr std::string_view kCut = " ... ";
  const std::size_t kept = max - kCut.size();
  const std::string_view head = internal::whole_characters(text, kept - kept / 2);
  std::string_view tail = text.substr(text.size() - kept / 2);
  // The tail must not begin within a multibyte character.
  while (!tail.empty() && (static_cast<unsigned char>(tail[0]) & 0xc0U) == 0x80)
    tail.remove_prefix(1);
  return std::string(head).append(kCut).append(tail);
}

}  // namespace

std::string error_line(const std::string& message) {
  std::string line = internal::visible_text(message);
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::replace(line.begin(), line.end(), '\t', ' ');
  return line.size() > kMaxError ? without_middle(line, kMaxError) : line;
}

}  // namespace quadtune::report
