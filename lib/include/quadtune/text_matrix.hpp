// SPDX-License-Identifier: Apache-2.0
/// Reads matrices from plain text.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

namespace quadtune {

/// Maximum size of a matrix text [bytes].
inline constexpr std::size_t kMatrixTextLimit = std::size_t{16} << 20;

/// Parses one row per line: numbers separated by blanks or commas. `#` starts a comment, and empty
/// lines are skipped. The decimal separator is a dot in every locale, and each number is rounded to
/// the nearest double.
///
/// @param text    The content of the file.
/// @param origin  The file's name in messages.
/// @return        (rows × columns), at least 1 × 1, all finite.
/// @throws InvalidInput  "origin:line: …" if a row has a different length, an entry is not a
///                       number, not finite, beyond the range of a double or has a decimal comma,
///                       if there are no numbers, or if the text is too long.
[[nodiscard]] Eigen::MatrixXd parse_text_matrix(const std::string& text, const std::string& origin);

/// Reads a matrix from a file, or from standard input if the path is "-".
/// @throws InvalidInput  as parse_text_matrix.
/// @throws FileError     if the file cannot be read.
[[nodiscard]] Eigen::MatrixXd read_text_matrix(const std::string& path);

}  // namespace quadtune
