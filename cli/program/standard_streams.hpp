// SPDX-License-Identifier: Apache-2.0
/// Stream buffers of standard input and output whose waits end at a signal, and one that makes
/// output safe for a terminal.
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
  /// @throws Interrupted  if a signal arrives while waiting for input; the input read so far is
  ///                      incomplete.
  /// @throws FileError    if it cannot be read.
  int_type underflow() override;

 private:
  std::array<char, 65536> bytes_;
};

/// Writes standard output. After a signal, a write that would wait for a reader fails.
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

/// Writes the result of internal::visible_text() to another stream. Multibyte characters may arrive
/// in pieces.
class VisibleText : public std::streambuf {
 public:
  /// @param width  of the terminal [characters]; the text is folded to it by report::folded() at
  ///               each flush; 0: not folded
  VisibleText(std::ostream& to, std::size_t width) : to_(to), width_(width) {}

 protected:
  int_type overflow(int_type next) override;
  std::streamsize xsputn(const char* text, std::streamsize count) override;
  int sync() override;

 private:
  /// @param all  whether no more text follows
  void write_out(bool all);

  std::ostream& to_;
  std::size_t width_;
  std::string waiting_;  // the first bytes of a character, or all text since the last flush if it
                         // is folded
};

/// Number of columns of the terminal of a descriptor, from the terminal itself or else from
/// COLUMNS; 0 if it is not a terminal.
[[nodiscard]] std::size_t terminal_width(int descriptor);

}  // namespace quadtune::cli
