// SPDX-License-Identifier: Apache-2.0
/// Readers for the uquad's logs: raw frames of its IMU, and the log that its main program writes.
#pragma once

#include <memory>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Whether the first line of a file is a frame: A, the time, eleven numbers, Z.
[[nodiscard]] bool is_uquad_frame(std::string_view line);

/// Opens frames "A T_us acc gyro magn temperature pressure Z", where T_us is the time since the
/// previous frame [us]. The first frame is at time 0.
[[nodiscard]] std::unique_ptr<LogReader> open_uquad_frames(ByteStream stream,
                                                           const LogOptions& options);

/// Opens imu_raw.log: seconds, microseconds, then the numbers of a frame, with or without T_us.
[[nodiscard]] std::unique_ptr<LogReader> open_uquad_log(ByteStream stream,
                                                        const LogOptions& options);

}  // namespace quadtune::internal
