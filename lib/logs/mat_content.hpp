// SPDX-License-Identifier: Apache-2.0
/// A MAT v5 file, compressed or not, decoded in this process.
#pragma once

#include <vector>

#include "logs/byte_stream.hpp"
#include "logs/mat_tables.hpp"

namespace quadtune::internal {

struct MatContent {
  std::vector<MatTable> tables;
  LogCondition condition;
};

/// Takes the file apart variable by variable: compressed ones are inflated with their checksum, the
/// skeleton of each is checked, and only then matio is let at it.
/// @param most  The largest variable, inflated [bytes].
/// @throws InvalidInput  for a file of another kind, or one of which nothing can be read.
[[nodiscard]] MatContent decode_mat(ByteStream& stream, std::size_t most);

}  // namespace quadtune::internal
