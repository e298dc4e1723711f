// SPDX-License-Identifier: Apache-2.0
/// The bytes of a MAT v5 file as arrays.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "logs/mat/mat_array.hpp"

namespace quadtune::internal {

/// The variables of a file that is not compressed. No claim in the file is trusted: every element
/// must lie within the one that holds it, the last one must end with the file, arrays of numbers
/// and texts must have exactly the bytes of the entries that they claim, and structs and cells must
/// hold as many arrays as they claim.
/// @param bytes   With the header. They must outlive the arrays.
/// @param origin  What messages call the file.
/// @throws InvalidInput    with what is there instead, or for a file that is compressed.
/// @throws std::bad_alloc  beyond the budget.
[[nodiscard]] std::vector<MatArray> parse_mat(std::string_view bytes, const std::string& origin,
                                              MemoryBudget& budget);

/// Refuses other kinds of files than MAT v5 of this machine's byte order.
/// @param bytes  The first 520, or all of a shorter file.
/// @throws InvalidInput  with the kind that it is.
void require_mat_header(std::string_view bytes, const std::string& origin);

}  // namespace quadtune::internal
