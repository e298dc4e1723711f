// SPDX-License-Identifier: Apache-2.0
/// Standard input and output for streams, so that a signal ends a wait for either, and what goes to
/// a terminal made fit for it.
#pragma once

#include <array>
#include <cstddef>
#include <ostream>
#include <streambuf>
#include <string>

namespace quadtune::cli {

/// Reads standard input.
class StandardInput : public std::streambuf {
 protected:
  /// @throws Interrupted  when a signal came while nothing else did; nothing of what was read so
  ///                      far may be taken for the whole.
  /// @throws FileError    if it cannot be read.
  int_type underflow() override;

 private:
  std::array<char, 65536> bytes_;
};

/// Writes standard output. After a signal a write that waits for a reader fails.
class StandardOutput : public std::streambuf {
 public:
  StandardOutput();
  ~StandardOutput() override;

 protected:
  int_type overflow(int_type next) override;
  int sync() override;

 private:
  bool write_out();

  std::array<char, 65536> bytes_;
};

/// Writes to another stream, as internal::visible_text(). Characters may come in pieces.
class VisibleText : public std::streambuf {
 public:
  /// @param width  of the terminal [characters], for which text is report::folded() at each flush;
  /// 0: none
  VisibleText(std::ostream& to, std::size_t width) : to_(to), width_(width) {}

 protected:
  int_type overflow(int_type next) override;
  std::streamsize xsputn(const char* text, std::streamsize count) override;
  int sync() override;

 private:
  /// @param all  whether nothing more comes
  void write_out(bool all);

  std::ostream& to_;
  std::size_t width_;
  std::string waiting_;  // the beginning of a character, or all until a flush where it is folded
};

/// Columns of the terminal that a descriptor is, by the terminal itself or else COLUMNS; 0 if it is
/// none.
[[nodiscard]] std::size_t terminal_width(int descriptor);

}  // namespace quadtune::cli
