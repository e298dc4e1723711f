// SPDX-License-Identifier: Apache-2.0
/// Words of a command line or of an option: lists, and numbers that are decimal, with a dot in
/// every locale.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace quadtune::internal {

/// "x,y,z" as words, which may be empty; an empty text has none.
[[nodiscard]] std::vector<std::string> comma_separated(const std::string& text);

/// Reads a word as a finite number; "+1" is accepted, "0x10", "1_000" and "1e999" are not.
/// @return  false, with `value` unchanged, for any other word.
[[nodiscard]] bool read_number(std::string_view word, double& value);

}  // namespace quadtune::internal
