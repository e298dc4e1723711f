// SPDX-License-Identifier: Apache-2.0
/// MAT v5 files of any program, read by matio in a guarded process.
#pragma once

#include <memory>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether a file begins as a MAT file does, v7.3 included.
[[nodiscard]] bool is_mat(std::string_view bytes);

/// @throws InvalidInput  for a file of which nothing can be read, or for which the process needs
///                       more memory or time than LogOptions allow.
[[nodiscard]] std::unique_ptr<LogReader> open_mat(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
