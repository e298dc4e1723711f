// SPDX-License-Identifier: Apache-2.0
/// quadtune lqr V --schedule GRID: gains over a grid of flights.
#pragma once

#include <string>
#include <vector>

#include "arguments/lqr_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/gain_schedule.hpp"

namespace quadtune::cli {

/// "speed=0:0.5:10, mass=1" as axes. The last value belongs to an axis: a step that does not lead
/// to it is refused.
/// @throws InvalidInput  at "--schedule": what came, what was expected and why.
[[nodiscard]] std::vector<ScheduleAxis> schedule_axes(const std::string& text);

/// Solves and prints: a summary, or with --json or -o the table.
/// @throws NoSolution  if no point has a gain.
void run_schedule(const LqrArguments& arguments, const std::string& grid, Context& context);

}  // namespace quadtune::cli
