// SPDX-License-Identifier: Apache-2.0
/// Reads MAT v5 files of any program as logs.
#pragma once

#include <memory>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether a file begins like a MAT file, v7.3 included.
[[nodiscard]] bool is_mat(std::string_view bytes);

/// @throws InvalidInput  if no part of the file can be read, or it needs more memory than
///                       LogOptions allow
[[nodiscard]] std::unique_ptr<LogReader> open_mat(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
