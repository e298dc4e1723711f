// SPDX-License-Identifier: Apache-2.0
/// MAT v5 files of any program as logs.
#pragma once

#include <memory>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether a file begins as a MAT file does, v7.3 included.
[[nodiscard]] bool is_mat(std::string_view bytes);

/// @throws InvalidInput  for a file of which nothing can be read, or that needs more memory than
///                       LogOptions allow.
[[nodiscard]] std::unique_ptr<LogReader> open_mat(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
