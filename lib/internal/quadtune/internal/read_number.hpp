// SPDX-License-Identifier: Apache-2.0
/// Numbers in words and options, read as in files: decimal, with a dot in every locale.
#pragma once

#include <string_view>

namespace quadtune::internal {

/// Reads a word as a finite number; "+1" is accepted, "0x10", "1_000" and "1e999" are not.
/// @return  false, with `value` unchanged, for any other word.
[[nodiscard]] bool read_number(std::string_view word, double& value);

}  // namespace quadtune::internal
