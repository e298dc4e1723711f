// SPDX-License-Identifier: Apache-2.0
/// Replay files of PX4's estimator: "t_us,sensor,value,value,…", one line per sample of any sensor.
#pragma once

#include <memory>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether the first line of a file has this format.
[[nodiscard]] bool is_replay(std::string_view line);

/// Each sensor becomes a group; its first line determines the number of its values.
[[nodiscard]] std::unique_ptr<LogReader> open_replay(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
