// SPDX-License-Identifier: Apache-2.0
/// Timed references from a table: a line of column names, then one row per time.
#pragma once

#include <string>

#include "quadtune/simulation/mission.hpp"

namespace quadtune::internal {

/// How the reference changes from row to row.
enum class Between {
  ramp,  ///< linear interpolation
  hold,  ///< each row is a step
};

/// Parses a table. The first line with content names the columns: t_s and height_m, and optionally
/// north_m, east_m, yaw_rad, which otherwise keep the values of `start`. The other lines are parsed
/// by parse_text_matrix().
/// @param origin  name of the file in messages
/// @throws InvalidInput  "origin:line: …"
[[nodiscard]] Script parse_script_csv(const std::string& text, const std::string& origin,
                                      const MissionStart& start, Between between);

}  // namespace quadtune::internal
