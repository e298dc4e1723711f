// SPDX-License-Identifier: Apache-2.0
/// The skeleton of a MAT v5 file, checked before matio is let at it.
#pragma once

#include <string>
#include <string_view>

namespace quadtune::internal {

/// Refuses bytes that are no whole MAT v5 file of this machine's byte order: every element must lie
/// within the one that holds it, the last end with the file, no array claim more entries than its
/// element has bytes, and arrays of numbers and texts have as many as they claim. matio takes such
/// claims on trust: it allocates what they say, and hands out memory that it never filled.
/// Compressed elements are refused, as nothing can be said of them from outside.
/// @param origin  What messages call the file.
/// @throws InvalidInput  with what is there instead.
void require_mat_v5(const std::string& bytes, const std::string& origin);

/// The part of it that the first 520 bytes tell: which kind of MAT file it is.
/// @throws InvalidInput  as require_mat_v5().
void require_mat_header(std::string_view bytes, const std::string& origin);

}  // namespace quadtune::internal
