// SPDX-License-Identifier: Apache-2.0
/// An error as one line, fit for a terminal whatever names and values it repeats.
#pragma once

#include <cstddef>
#include <string>

namespace quadtune::report {

/// The longest error [bytes].
inline constexpr std::size_t kLongestError = 500;

/// A message as the one line of an error: no line feeds, internal::visible_text(), and where it is
/// longer than kLongestError its middle left out. Messages begin with the place and end with what
/// was expected and why; what was given, which may be of any length, is between these.
[[nodiscard]] std::string error_line(const std::string& message);

}  // namespace quadtune::report
