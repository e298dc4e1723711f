// SPDX-License-Identifier: Apache-2.0
/// What the program says, fit for a terminal whatever names and values it repeats.
#pragma once

#include <cstddef>
#include <ostream>
#include <streambuf>
#include <string>

namespace quadtune::cli {

/// The longest error [bytes].
inline constexpr std::size_t kLongestError = 500;

/// A message as the one line of an error: no line feeds, internal::visible_text(), and where it is
/// longer than kLongestError its middle left out. Messages begin with the place and end with what
/// was expected and why; what was given, which may be of any length, is between these.
[[nodiscard]] std::string error_line(const std::string& message);

/// Writes to another stream, as internal::visible_text(). Characters may come in pieces.
class VisibleText : public std::streambuf {
 public:
  /// @param width  of the terminal [characters], for which text is folded() at each flush; 0: none
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

}  // namespace quadtune::cli
