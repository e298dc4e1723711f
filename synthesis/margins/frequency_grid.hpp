// SPDX-License-Identifier: Apache-2.0
/// What is found between the frequencies of a loop's grid, frequency_grid().
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "quadtune/synthesis/open_loop.hpp"

namespace quadtune::internal {

/// frequency_grid() around given poles and zeros.
/// @param dt     [s]; 0: they are of continuous time
/// @param delay  [s] beside them, of a continuous loop
[[nodiscard]] std::vector<double> grid_around(const std::vector<Eigen::VectorXcd>& roots, double dt,
                                              double delay);

/// The root of f in [low, high], at whose ends f has opposite signs, by bisection to rounding.
[[nodiscard]] double refine_root(const std::function<double(double)>& f, double low, double high);

/// The largest value of f, given its values on the grid: each peak of the grid that comes near the
/// largest is climbed by Brent's method. Returns value and place.
/// @param width  how near, relative, its place is looked for; its height is known to the square
[[nodiscard]] std::pair<double, double> refine_peak(const std::function<double(double)>& f,
                                                    const std::vector<double>& grid,
                                                    const std::vector<double>& values,
                                                    double width = 1e-9);

}  // namespace quadtune::internal
