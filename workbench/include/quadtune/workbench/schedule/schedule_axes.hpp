// SPDX-License-Identifier: Apache-2.0
/// The grid of a gain schedule, written in one line.
#pragma once

#include <string>
#include <vector>

#include "quadtune/gain_schedule.hpp"

namespace quadtune {

/// Parses "speed=0:0.5:10, mass=1" to axes, each first:step:last or one value. The last value
/// belongs to the axis: a step that does not reach it is rejected.
/// @param text   one or more axes, separated by commas
/// @param where  prefix of InvalidInput, e.g. "--schedule"
/// @throws OptionError   "schedule", if the text is malformed or the steps do not reach the last
///                       value
/// @throws InvalidInput  as schedule_quantity() and checked_grid_size()
[[nodiscard]] std::vector<ScheduleAxis> schedule_axes(const std::string& text,
                                                      const std::string& where);

}  // namespace quadtune
