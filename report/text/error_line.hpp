// SPDX-License-Identifier: Apache-2.0
/// An error as one line that is safe for a terminal, whatever names and values it contains.
#pragma once

#include <cstddef>
#include <string>

namespace quadtune::report {

/// Maximum length of an error [bytes].
inline constexpr std::size_t kMaxError = 500;

/// Converts a message to the one line of an error: without line feeds, processed by
/// internal::visible_text(), and with its middle omitted if it is longer than kMaxError.
/// Messages begin with the location and end with what was expected and why; the given value, which
/// may be of any length, is between these.
[[nodiscard]] std::string error_line(const std::string& message);

}  // namespace quadtune::report
