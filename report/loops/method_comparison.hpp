// SPDX-License-Identifier: Apache-2.0
/// What sampling makes of a vehicle's closed loops: for `discretize V --compare`.
#pragma once

#include <string>

#include "arguments/plot_argument.hpp"

namespace quadtune::cli {

struct Context;

/// Compares every method at dt/2, dt and 2 dt, for the loop of an LQR gain and of the PID cascade,
/// and prints.
/// @param vehicle  name or file
/// @param dt       [s], > 0
/// @param flown    whether the same laws are judged on the plant that flies as well
/// @throws NoSolution  when the vehicle cannot hover or a law cannot be had
void compare_methods(const std::string& vehicle, double dt, bool flown, const PlotArgument& plot,
                     Context& context);

}  // namespace quadtune::cli
