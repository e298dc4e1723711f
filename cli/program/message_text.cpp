// SPDX-License-Identifier: Apache-2.0
#include "program/message_text.hpp"

#include <algorithm>
#include <string_view>

#include "program/fold_text.hpp"
#include "quadtune/internal/utf8.hpp"

namespace quadtune::cli {
namespace {

/// `text` without its middle, at most `most` bytes.
std::string without_middle(std::string_view text, std::size_t most) {
  constexpr std::string_view kCut = " ... ";
  const std::size_t kept = most - kCut.size();
  const std::string_view head = internal::whole_characters(text, kept - kept / 2);
  std::string_view tail = text.substr(text.size() - kept / 2);
  // Not from within a character.
  while (!tail.empty() && (static_cast<unsigned char>(tail[0]) & 0xc0U) == 0x80)
    tail.remove_prefix(1);
  return std::string(head).append(kCut).append(tail);
}

}  // namespace

std::string error_line(const std::string& message) {
  std::string line = internal::visible_text(message);
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::replace(line.begin(), line.end(), '\t', ' ');
  return line.size() > kLongestError ? without_middle(line, kLongestError) : line;
}

VisibleText::int_type VisibleText::overflow(int_type next) {
  if (traits_type::eq_int_type(next, traits_type::eof())) return traits_type::not_eof(next);
  const char c = traits_type::to_char_type(next);
  return xsputn(&c, 1) == 1 ? next : traits_type::eof();
}

std::streamsize VisibleText::xsputn(const char* text, std::streamsize count) {
  waiting_.append(text, static_cast<std::size_t>(count));
  write_out(false);
  return to_ ? count : 0;
}

int VisibleText::sync() {
  write_out(true);
  to_.flush();
  return to_ ? 0 : -1;
}

void VisibleText::write_out(bool all) {
  if (width_ > 0) {
    if (!all) return;
    to_ << folded(internal::visible_text(waiting_), width_);
    waiting_.clear();
    return;
  }
  std::size_t ready = waiting_.size();
  // The last bytes may be the beginning of a character that goes on.
  for (std::size_t back = 1; !all && back <= std::min<std::size_t>(3, waiting_.size()); ++back) {
    const auto byte = static_cast<unsigned char>(waiting_[waiting_.size() - back]);
    if ((byte & 0xc0U) == 0x80) continue;
    const std::size_t length = byte >= 0xf0 ? 4 : byte >= 0xe0 ? 3 : byte >= 0xc0 ? 2 : 1;
    if (back < length) ready = waiting_.size() - back;
    break;
  }
  to_ << internal::visible_text(std::string_view(waiting_).substr(0, ready));
  waiting_.erase(0, ready);
}

}  // namespace quadtune::cli
