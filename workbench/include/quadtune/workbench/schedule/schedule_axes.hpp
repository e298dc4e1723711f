// SPDX-License-Identifier: Apache-2.0
/// The grid of a gain schedule, written in one line.
#pragma once

#include <string>
#include <vector>

#include "quadtune/gain_schedule.hpp"

namespace quadtune {

/// "speed=0:0.5:10, mass=1" as axes, each first:step:last or one value. The last value belongs to
/// an axis: a step that does not lead to it is refused.
/// @param where  for the place of InvalidInput, e.g. "--schedule"
/// @throws OptionError   "schedule", for text that is no axis, or steps that do not meet the last
///                       value
/// @throws InvalidInput  as schedule_quantity() and checked_grid_size()
[[nodiscard]] std::vector<ScheduleAxis> schedule_axes(const std::string& text,
                                                      const std::string& where);

}  // namespace quadtune
