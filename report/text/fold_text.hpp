// SPDX-License-Identifier: Apache-2.0
/// Text for a terminal that is narrower than it.
#pragma once

#include <cstddef>
#include <string>

namespace quadtune::report {

/// `text` with no line longer than `width` characters, where its words allow that. A table, lines
/// whose columns are two blanks or more apart, becomes several, one below the other, each with as
/// many columns as fit and the rows' names before them. Other lines go on below their text.
/// @param width  [characters]; 0: as it is
[[nodiscard]] std::string folded(const std::string& text, std::size_t width);

}  // namespace quadtune::report
