// SPDX-License-Identifier: Apache-2.0
#include "program/standard_streams.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "program/stop_signals.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/utf8.hpp"
#include "report/text/fold_text.hpp"

namespace quadtune::cli {

StandardInput::int_type StandardInput::underflow() {
  while (true) {
    const ssize_t got = ::read(STDIN_FILENO, bytes_.data(), bytes_.size());
    if (got > 0) {
      setg(bytes_.data(), bytes_.data(), bytes_.data() + got);
      return traits_type::to_int_type(bytes_[0]);
    }
    if (got == 0) return traits_type::eof();
    if (errno != EINTR) throw FileError("standard input", std::strerror(errno));
    if (interrupted()) throw Interrupted();
  }
}

StandardOutput::StandardOutput() { setp(bytes_.data(), bytes_.data() + bytes_.size()); }

StandardOutput::~StandardOutput() { (void)write_out(); }

StandardOutput::int_type StandardOutput::overflow(int_type next) {
  if (!write_out()) return traits_type::eof();
  if (!traits_type::eq_int_type(next, traits_type::eof())) sputc(traits_type::to_char_type(next));
  return traits_type::not_eof(next);
}

int StandardOutput::sync() { return write_out() ? 0 : -1; }

bool StandardOutput::write_out() {
  const char* at = pbase();
  const char* const end = pptr();
  // Bytes that could not be written are discarded.
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  if (at != end) standard_output_has_begun();
  while (at != end) {
    const ssize_t done = ::write(STDOUT_FILENO, at, static_cast<std::size_t>(end - at));
    if (done < 0 && errno == EINTR && !interrupted()) continue;
    if (done < 0) return false;
    at += done;
  }
  return true;
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
    to_ << report::folded(internal::visible_text(waiting_), width_);
    waiting_.clear();
    return;
  }
  std::size_t ready = waiting_.size();
  // The last bytes may be the beginning of a multibyte character.
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

std::size_t terminal_width(int descriptor) {
  constexpr std::size_t kUsual = 80;
  if (::isatty(descriptor) == 0) return 0;
  winsize size = {};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* const columns = std::getenv("COLUMNS");
  std::size_t width = 0;
  if (columns == nullptr ||
      std::from_chars(columns, columns + std::strlen(columns), width).ec != std::errc() ||
      width == 0)
    return kUsual;
  return width;
}

}  // namespace quadtune::cli
