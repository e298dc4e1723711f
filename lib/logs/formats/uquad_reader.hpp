// SPDX-License-Identifier: Apache-2.0
/// The uquad's logs: raw frames of its IMU, and the main program's log of them.
#pragma once

#include <memory>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether the first line of a file is a frame: A, eleven numbers and the time before them, Z.
[[nodiscard]] bool is_uquad_frame(std::string_view line);

/// "A T_us acc gyro magn temperature pressure Z", T_us the time since the frame before [us]. The
/// first frame is at 0.
[[nodiscard]] std::unique_ptr<LogReader> open_uquad_frames(ByteStream stream,
                                                           const LogOptions& options);

/// imu_raw.log: seconds, microseconds, then what a frame holds, with or without its T_us.
[[nodiscard]] std::unique_ptr<LogReader> open_uquad_log(ByteStream stream,
                                                        const LogOptions& options);

}  // namespace quadtune::internal
