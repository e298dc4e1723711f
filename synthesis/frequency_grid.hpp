// SPDX-License-Identifier: Apache-2.0
/// Frequencies at which a loop must be looked at, and what is found between them.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "quadtune/synthesis/open_loop.hpp"

namespace quadtune::internal {

/// Increasing frequencies [rad/s] from 0 to far beyond the fastest pole, or to Nyquist: forty a
/// decade, more around each pole and zero of the open and of the closed loop, whose distance to the
/// boundary is the width of what it does to the response; with a delay, as many that it turns the
/// phase by less than 0.2 rad between two.
[[nodiscard]] std::vector<double> frequency_grid(const OpenLoop& loop);

/// The root of f in [low, high], at whose ends f has opposite signs, by bisection to rounding.
[[nodiscard]] double refine_root(const std::function<double(double)>& f, double low, double high);

/// The largest value of f, given its values on the grid: each peak of the grid that comes near the
/// largest is climbed by golden section. Returns value and place.
/// @param width  how near, relative, its place is looked for; its height is known to the square
[[nodiscard]] std::pair<double, double> refine_peak(const std::function<double(double)>& f,
                                                    const std::vector<double>& grid,
                                                    const std::vector<double>& values,
                                                    double width = 1e-9);

}  // namespace quadtune::internal
