// SPDX-License-Identifier: Apache-2.0
/// Messages about a log, forwarded while it is read.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "quadtune/logs/log_reader.hpp"

namespace quadtune {

/// Receives one line for the user as soon as it is known, so that the user sees it even if an error
/// follows. May be empty.
using LogNote = std::function<void(const std::string& line)>;

/// One line for each defect of the file or irregularity of its recording.
[[nodiscard]] std::vector<std::string> log_warnings(const LogCondition& condition);

/// The same, with the file's name before each.
/// @param condition  of the log
/// @param file       name of the file in messages
/// @param note       receives each of them, after "warning: "
[[nodiscard]] std::vector<std::string> noted_log_warnings(const LogCondition& condition,
                                                          const std::string& file,
                                                          const LogNote& note);

}  // namespace quadtune
