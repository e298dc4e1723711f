// SPDX-License-Identifier: Apache-2.0
/// Reader for PX4's ULog.
#pragma once

#include <memory>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether a file begins like a ULog file.
[[nodiscard]] bool is_ulog(std::string_view bytes);

/// Each instance of a topic becomes a group: "sensor_baro", "sensor_baro.1".
/// @throws InvalidInput  if the bytes are not a ULog, or a newer version with incompatible flags
[[nodiscard]] std::unique_ptr<LogReader> open_ulog(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
