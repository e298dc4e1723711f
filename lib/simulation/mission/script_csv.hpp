// SPDX-License-Identifier: Apache-2.0
/// Timed references from a table of numbers: a line of names, then a row for each time.
#pragma once

#include <string>

#include "quadtune/simulation/mission.hpp"

namespace quadtune::internal {

/// How the reference goes from row to row.
enum class Between {
  ramp,  ///< along a straight line
  hold,  ///< not at all: each row is a step
};

/// Parses a table: the first line that holds something names the columns, t_s and height_m, and
/// north_m, east_m, yaw_rad where they are not those of `start`; the rest is text that
/// parse_text_matrix() reads.
/// @param origin  what messages call the file.
/// @throws InvalidInput  "origin:line: …"
[[nodiscard]] Script parse_script_csv(const std::string& text, const std::string& origin,
                                      const MissionStart& start, Between between);

}  // namespace quadtune::internal
