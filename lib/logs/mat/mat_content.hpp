// SPDX-License-Identifier: Apache-2.0
/// A MAT v5 file, compressed or not, decoded in this process.
#pragma once

#include <cstddef>
#include <vector>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// A group with its numbers, whole.
struct MatTable {
  LogGroup group;
  std::vector<double> time;                  ///< [s]; empty where the group is not timed
  std::vector<std::vector<double>> columns;  ///< one a channel, all of one length

  [[nodiscard]] std::size_t rows() const {
    return columns.empty() ? time.size() : columns.front().size();
  }
};

struct MatContent {
  std::vector<MatTable> tables;
  LogCondition condition;
};

/// Takes the file apart variable by variable. Compressed ones are inflated with their checksum, and
/// one that is damaged is skipped.
/// @param memory_limit  Of all variables, inflated, and of the tables [bytes].
/// @throws InvalidInput  for a file of another kind, one of which nothing can be read, or one that
///                       needs more memory.
[[nodiscard]] MatContent decode_mat(ByteStream& stream, std::size_t memory_limit);

}  // namespace quadtune::internal
