// SPDX-License-Identifier: Apache-2.0
/// The picture of an Allan deviation: points with intervals, the fit and its noises.
#pragma once

#include "report/logs/allan_units.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

[[nodiscard]] Figure allan_figure(const AllanRecord& record, const AllanAnalysis& analysis);

}  // namespace quadtune::report
