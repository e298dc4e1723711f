// SPDX-License-Identifier: Apache-2.0
/// A matrix that is written in a word, not in a file.
#pragma once

#include <optional>
#include <string>

namespace quadtune {

/// "0 1; 0 0", "[0 1; 0 0]" or "[[0, 1], [0, 0]]" as the lines of a matrix file, for
/// parse_text_matrix(); none for other words, and for the name of a file that exists.
[[nodiscard]] std::optional<std::string> matrix_lines(const std::string& word);

}  // namespace quadtune
