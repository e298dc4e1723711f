// SPDX-License-Identifier: Apache-2.0
/// Conversion between UTF-8 and the UTF-16 of MAT files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// Converts `text` to UTF-16; empty if it is not valid UTF-8: truncated, overlong, a surrogate,
/// beyond U+10FFFF.
[[nodiscard]] std::optional<std::u16string> utf16_of(std::string_view text);

/// Converts `text` to UTF-8; empty if it contains an unpaired surrogate.
[[nodiscard]] std::optional<std::string> utf8_of(std::u16string_view text);

}  // namespace quadtune::internal
