// SPDX-License-Identifier: Apache-2.0
/// Converts the variables of a MAT file to groups of channels.
#pragma once

#include <string>
#include <vector>

#include "logs/mat/mat_array.hpp"
#include "logs/mat/mat_content.hpp"

namespace quadtune::internal {

/// Finds the logs among variables, in their order:
/// - structs with `time` and `signals`, as written by Simulink: one group each;
/// - other structs with their contents, and all plain variables together: one group per number of
/// rows. A vector named t, time, timestamp, tout (or with its unit: t_us) is their clock.
/// A matrix of N rows is N rows of channels x[1], x[2], …; a row vector is one channel; in arrays
/// of three dimensions the last dimension counts the rows.
/// @param notes  receives a note for each variable that is ignored
/// @throws std::bad_alloc  if the budget is exceeded
[[nodiscard]] std::vector<MatTable> tables_of(const std::vector<MatArray>& variables,
                                              MemoryBudget& budget,
                                              std::vector<std::string>& notes);

}  // namespace quadtune::internal
