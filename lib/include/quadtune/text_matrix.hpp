// SPDX-License-Identifier: Apache-2.0
/// Reads matrices from plain text, as people and flight programs write them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

namespace quadtune {

/// Largest matrix text that is read [bytes].
inline constexpr std::size_t kMatrixTextLimit = std::size_t{16} << 20;

/// Parses one row a line: numbers separated by blanks or commas, `#` starts a comment, lines with
/// nothing else are skipped. The decimal sign is a dot whatever the locale, and a number becomes
/// the nearest double.
///
/// @param text    The file's bytes.
/// @param origin  What messages call the file.
/// @return        (rows × columns), at least 1 × 1, all finite.
/// @throws InvalidInput  "origin:line: …" for a ragged row, a word, nan or infinity, a number too
///                       large for a double, a decimal comma, no numbers at all, or too long a
///                       text.
[[nodiscard]] Eigen::MatrixXd parse_text_matrix(const std::string& text, const std::string& origin);

/// Reads a matrix file; "-" is standard input.
/// @throws InvalidInput  as parse_text_matrix.
/// @throws FileError     if the file cannot be read.
[[nodiscard]] Eigen::MatrixXd read_text_matrix(const std::string& path);

}  // namespace quadtune
