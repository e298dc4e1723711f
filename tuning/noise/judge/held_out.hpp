// SPDX-License-Identifier: Apache-2.0
/// Whether a held-out part is more likely with the result of the fit.
#pragma once

#include <vector>

#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune::internal {

/// @param before        runs over the held-out part with the covariances before; empty: there are
///                      none
/// @param after         runs with those after
/// @param significance  probability of a false alarm
[[nodiscard]] HoldOut judge_held_out(const FilterModel& model, const std::vector<FilterRun>& before,
                                     const std::vector<FilterRun>& after, double significance);

}  // namespace quadtune::internal
