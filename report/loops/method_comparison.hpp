// SPDX-License-Identifier: Apache-2.0
/// What sampling makes of a vehicle's closed loops, as text, JSON and picture.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/sampling/method_comparison.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// "vehicle", "dt", "methods", "not_compared", "flown" where it was asked for.
[[nodiscard]] internal::Json to_json(const MethodComparison& comparison);
[[nodiscard]] std::string to_text(const MethodComparison& comparison);

/// The set point of x of the cascade: the slowest chain of loops, where periods matter least, and
/// the fastest poles, where they matter most.
[[nodiscard]] Figure sampling_figure(const MethodComparison& methods);

}  // namespace quadtune::report
