// SPDX-License-Identifier: Apache-2.0
/// Whether a stretch that a fit has not seen is likelier with what it found.
#pragma once

#include <vector>

#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune::internal {

/// @param before        runs over the stretch by the covariances before; empty: there are none
/// @param after         by those after
/// @param significance  probability of a false alarm
[[nodiscard]] HoldOut judge_held_out(const FilterModel& model, const std::vector<FilterRun>& before,
                                     const std::vector<FilterRun>& after, double significance);

}  // namespace quadtune::internal
