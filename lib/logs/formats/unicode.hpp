// SPDX-License-Identifier: Apache-2.0
/// Text between UTF-8 and the UTF-16 of MAT files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// `text` in UTF-16; nothing where it is not UTF-8: cut short, overlong, a surrogate, beyond
/// U+10FFFF.
[[nodiscard]] std::optional<std::u16string> utf16_of(std::string_view text);

/// `text` in UTF-8; nothing where a surrogate stands alone.
[[nodiscard]] std::optional<std::string> utf8_of(std::u16string_view text);

}  // namespace quadtune::internal
