// SPDX-License-Identifier: Apache-2.0
/// A number with its noun in the singular or the plural, for messages.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace quadtune::internal {

/// "1 row", "2 rows"; "1 entry", "2 entries".
/// @param one   the noun in the singular
/// @param many  in the plural; empty: with an s
[[nodiscard]] inline std::string counted(std::integral auto count, std::string_view one,
                                         std::string_view many = {}) {
  std::string text = std::to_string(count) + " ";
  if (count == 1) return text.append(one);
  return many.empty() ? text.append(one).append("s") : text.append(many);
}

}  // namespace quadtune::internal
