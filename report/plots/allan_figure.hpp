// SPDX-License-Identifier: Apache-2.0
/// The picture of an Allan deviation: points with intervals, the fit and its noise components.
#pragma once

#include "quadtune/workbench/logs/allan_of_log.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

[[nodiscard]] Figure allan_figure(const SensorAllan& allan);

}  // namespace quadtune::report
