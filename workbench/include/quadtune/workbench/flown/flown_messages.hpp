// SPDX-License-Identifier: Apache-2.0
/// Messages for the user about a law and its flown loop.
#pragma once

#include <string>
#include <vector>

#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// "note: …" for each of `notes`, of flown_notes() and of margin_notes(); "warning: …" for a loop
/// that grows, and for margin_warnings().
/// @param notes  from the law's design
[[nodiscard]] std::vector<std::string> flown_messages(const std::vector<std::string>& notes,
                                                      const FlownLoop& flown);

}  // namespace quadtune
