// SPDX-License-Identifier: Apache-2.0
/// Decodes a MAT v5 file, compressed or not, within this process.
#pragma once

#include <cstddef>
#include <vector>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// A group with all of its values.
struct MatTable {
  LogGroup group;
  std::vector<double> time;                  ///< [s]; empty if the group has no times
  std::vector<std::vector<double>> columns;  ///< one per channel, all of the same length

  [[nodiscard]] std::size_t rows() const {
    return columns.empty() ? time.size() : columns.front().size();
  }
};

struct MatContent {
  std::vector<MatTable> tables;
  LogCondition condition;
};

/// Decodes the file variable by variable. Compressed variables are inflated and their checksums
/// verified; damaged ones are skipped.
/// @param memory_limit  for all inflated variables and for the tables [bytes]
/// @throws InvalidInput  if the file has another format, no part of it can be read, or it needs
///                       more memory
[[nodiscard]] MatContent decode_mat(ByteStream& stream, std::size_t memory_limit);

}  // namespace quadtune::internal
