// SPDX-License-Identifier: Apache-2.0
/// Parses words of a command line or an option: lists, and decimal numbers with a dot in every
/// locale.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace quadtune::internal {

/// Splits "x,y,z" into words, which may be empty; an empty text has no words.
[[nodiscard]] std::vector<std::string> comma_separated(const std::string& text);

/// Parses a word as a finite number; "+1" is accepted, "0x10", "1_000" and "1e999" are not.
/// @return  false for any other word; `value` is then unchanged.
[[nodiscard]] bool read_number(std::string_view word, double& value);

}  // namespace quadtune::internal
