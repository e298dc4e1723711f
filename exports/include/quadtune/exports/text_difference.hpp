// SPDX-License-Identifier: Apache-2.0
/// Locates differences between two texts.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace quadtune {

/// The number of the first line that differs, counted from 1; 0 if the texts are equal.
[[nodiscard]] std::size_t first_other_line(const std::string& a, const std::string& b);

/// Compares two texts, such as the output of two machines, that may differ only in their numbers,
/// including the signs, and in the blanks before the numbers. Numbers that are not finite count as
/// words.
/// @return  the largest difference of corresponding numbers, relative to the largest number of
///          their line; no value if a word or a punctuation character differs
[[nodiscard]] std::optional<double> numbers_apart(const std::string& a, const std::string& b);

}  // namespace quadtune
