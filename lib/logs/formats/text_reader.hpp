// SPDX-License-Identifier: Apache-2.0
/// CSV and blank-separated text, with a line of names or without.
#pragma once

#include <memory>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// @param format  What the reader calls its format.
/// @throws InvalidInput  if the stream holds no such text, or the options do not fit it.
[[nodiscard]] std::unique_ptr<LogReader> open_text(ByteStream stream, const LogOptions& options,
                                                   const std::string& format);

}  // namespace quadtune::internal
