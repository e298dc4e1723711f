// SPDX-License-Identifier: Apache-2.0
/// Folding of text that is wider than the terminal.
#pragma once

#include <cstddef>
#include <string>

namespace quadtune::report {

/// Folds `text` so that no line is longer than `width` characters, if its words allow that. A
/// table, i.e. lines whose columns are separated by two blanks or more, is divided into several
/// tables, one below the other, each with as many columns as fit and with the names of the rows.
/// Other lines are wrapped and indented below their text.
/// @param width  [characters]; 0: returns the text unchanged
[[nodiscard]] std::string folded(const std::string& text, std::size_t width);

}  // namespace quadtune::report
