// SPDX-License-Identifier: Apache-2.0
/// Replays of PX4's estimator: "t_us,sensor,value,value,…", one line a sample of any sensor.
#pragma once

#include <memory>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether the first line of a file looks like that.
[[nodiscard]] bool is_replay(std::string_view line);

/// Each sensor becomes a group; the first line of it tells how many values it has.
[[nodiscard]] std::unique_ptr<LogReader> open_replay(ByteStream stream, const LogOptions& options);

}  // namespace quadtune::internal
