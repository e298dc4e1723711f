// SPDX-License-Identifier: Apache-2.0
/// What a user should be told of a law and of its flown loop.
#pragma once

#include <string>
#include <vector>

#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// "note: …" for each of `notes`, of flown_notes() and of margin_notes(); "warning: …" of a loop
/// that grows, and of margin_warnings().
/// @param notes  of the law's design
[[nodiscard]] std::vector<std::string> flown_messages(const std::vector<std::string>& notes,
                                                      const FlownLoop& flown);

}  // namespace quadtune
