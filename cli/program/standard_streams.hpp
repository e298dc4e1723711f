// SPDX-License-Identifier: Apache-2.0
/// Standard input and output for streams, so that a signal ends a wait for either.
#pragma once

#include <array>
#include <streambuf>

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

}  // namespace quadtune::cli
