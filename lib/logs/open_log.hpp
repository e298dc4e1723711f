// SPDX-License-Identifier: Apache-2.0
/// Opens a log in a file or in memory.
#pragma once

#include <memory>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// As quadtune::open_log().
[[nodiscard]] std::unique_ptr<LogReader> open_log(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
