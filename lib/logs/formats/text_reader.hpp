// SPDX-License-Identifier: Apache-2.0
/// Reader for CSV and blank-separated text, with or without a line of names.
#pragma once

#include <memory>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// @param format  name that the reader reports as its format
/// @throws InvalidInput  if the stream does not contain such text, or the options do not fit it
[[nodiscard]] std::unique_ptr<LogReader> open_text(ByteStream stream, const LogOptions& options,
                                                   const std::string& format);

}  // namespace quadtune::internal
