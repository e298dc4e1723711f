// SPDX-License-Identifier: Apache-2.0
/// A matrix that is given as a command-line word instead of a file.
#pragma once

#include <optional>
#include <string>

namespace quadtune {

/// Converts "0 1; 0 0", "[0 1; 0 0]" or "[[0, 1], [0, 0]]" to the lines of a matrix file, for
/// parse_text_matrix(); no value for other words, and for the name of an existing file.
[[nodiscard]] std::optional<std::string> matrix_lines(const std::string& word);

}  // namespace quadtune
