// SPDX-License-Identifier: Apache-2.0
/// Which figures of a campaign are shown, and how.
#pragma once

#include <string>

#include "quadtune/simulation/campaign_statistics.hpp"
#include "quadtune/simulation/metric.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune::report {

/// Whether a figure is among those that a reader looks for first; others are in the database.
[[nodiscard]] bool is_shown(Metric metric);

/// The unit; empty of a figure without one.
[[nodiscard]] std::string unit_shown(Metric metric);

/// The mission's limit on a metric; NaN where there is none.
[[nodiscard]] double limit_of(const Mission& mission, Metric metric);

/// Whether an interval does not hold 0.
[[nodiscard]] bool surely_not_zero(const Estimated& e);

}  // namespace quadtune::report
