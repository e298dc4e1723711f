// SPDX-License-Identifier: Apache-2.0
/// The variables of a MAT file as groups of channels.
#pragma once

#include <string>
#include <vector>

#include "logs/mat/mat_array.hpp"
#include "logs/mat/mat_content.hpp"

namespace quadtune::internal {

/// Finds what is a log in variables, in their order:
/// - structs with `time` and `signals`, as Simulink writes them: a group each;
/// - other structs, with what they hold, and all plain variables together: a group for each number
///   of rows. A vector called t, time, timestamp, tout (or with its unit: t_us) is their clock.
/// A matrix of N rows is N rows of channels x[1], x[2], …; a row vector is one channel; of three
/// dimensions the last one counts the rows.
/// @param notes  What was passed over is added.
/// @throws std::bad_alloc  beyond the budget.
[[nodiscard]] std::vector<MatTable> tables_of(const std::vector<MatArray>& variables,
                                              MemoryBudget& budget,
                                              std::vector<std::string>& notes);

}  // namespace quadtune::internal
