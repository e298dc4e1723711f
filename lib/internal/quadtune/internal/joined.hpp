// SPDX-License-Identifier: Apache-2.0
/// Joins words with a separator. Like fmt::join(), but compiled once.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::internal {

/// "a, b, c"; "" if there are no words.
[[nodiscard]] std::string joined(const std::vector<std::string>& words, std::string_view separator);
[[nodiscard]] std::string joined(const std::set<std::string>& words, std::string_view separator);
[[nodiscard]] std::string joined(std::span<const char* const> words, std::string_view separator);
[[nodiscard]] std::string joined(std::span<const std::string_view> words,
                                 std::string_view separator);

}  // namespace quadtune::internal
