// SPDX-License-Identifier: Apache-2.0
/// Parses the bytes of a MAT v5 file into arrays.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "logs/mat/mat_array.hpp"

namespace quadtune::internal {

/// Parses the variables of an uncompressed file. No size in the file is trusted: every element must
/// lie within the one that contains it, the last one must end with the file, numeric and text
/// arrays must have exactly the bytes of their stated entries, and structs and cells must contain
/// the stated number of arrays.
/// @param bytes   including the header; they must outlive the arrays
/// @param origin  name of the file in messages
/// @throws InvalidInput    if the file is malformed, with a description, or compressed
/// @throws std::bad_alloc  if the budget is exceeded
[[nodiscard]] std::vector<MatArray> parse_mat(std::string_view bytes, const std::string& origin,
                                              MemoryBudget& budget);

/// Rejects files other than MAT v5 in this machine's byte order.
/// @param bytes  the first 520, or all of a shorter file
/// @throws InvalidInput  naming the actual kind of file
void require_mat_header(std::string_view bytes, const std::string& origin);

}  // namespace quadtune::internal
