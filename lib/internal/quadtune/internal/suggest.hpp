// SPDX-License-Identifier: Apache-2.0
/// "did you mean …?" suggestions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace quadtune::internal {

/// The minimum number of single-letter insertions, deletions and replacements between two words.
[[nodiscard]] std::size_t edit_distance(const std::string& a, const std::string& b);

/// The known word nearest to `word`, or "" if none is close enough.
[[nodiscard]] std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// "; did you mean 'lqr'?", or "" if no known word is close enough.
[[nodiscard]] std::string did_you_mean(const std::string& word,
                                       const std::vector<std::string>& known);

}  // namespace quadtune::internal
