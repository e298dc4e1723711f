// SPDX-License-Identifier: Apache-2.0
/// Where two texts differ.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace quadtune {

/// The first line that differs, from 1; 0 where none does.
[[nodiscard]] std::size_t first_other_line(const std::string& a, const std::string& b);

/// Compares two texts that may differ in their numbers alone, as those of two machines may: in
/// their signs as well, and in the blanks before them. Numbers that are not finite count as words.
/// @return  the largest difference of two numbers in the same place, over the largest number of
///          their line; no value if a word or a sign differs
[[nodiscard]] std::optional<double> numbers_apart(const std::string& a, const std::string& b);

}  // namespace quadtune
