// SPDX-License-Identifier: Apache-2.0
/// Gains over a grid of flights, in a summary. As JSON the schedule is its own table:
/// schedule_text().
#pragma once

#include <string>

#include "quadtune/gain_schedule.hpp"

namespace quadtune::report {

/// The grid, how many points have a gain, and the first of these gains.
/// @param schedule  with one gain at least
[[nodiscard]] std::string to_text(const GainSchedule& schedule);

}  // namespace quadtune::report
