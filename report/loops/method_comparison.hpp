// SPDX-License-Identifier: Apache-2.0
/// What sampling makes of a vehicle's closed loops: for `discretize V --compare`.
#pragma once

#include <functional>
#include <string>

#include "quadtune/internal/json_value.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// The comparison as JSON and as text.
struct MethodComparison {
  internal::Json json;
  std::string text;
  std::function<Figure()> figure;  ///< of the cascade, drawn where it is asked for
};

/// Compares every method at dt/2, dt and 2 dt, for the loop of an LQR gain and of the PID cascade.
/// @param vehicle  name or file
/// @param dt       [s], > 0
/// @param flown    whether the same laws are judged on the plant that flies as well
/// @throws NoSolution  when the vehicle cannot hover or a law cannot be had
[[nodiscard]] MethodComparison compare_methods(const std::string& vehicle, double dt, bool flown);

}  // namespace quadtune::report
