// SPDX-License-Identifier: Apache-2.0
#include "program/standard_streams.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "program/stop_signals.hpp"
#include "quadtune/errors.hpp"

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
  // What could not be written is not tried again.
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

}  // namespace quadtune::cli
