// SPDX-License-Identifier: Apache-2.0
/// What autocovariances say of each parameter, and how well.
#pragma once

#include <vector>

#include "noise/autocovariance/autocovariance_search.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"

namespace quadtune::internal {

/// Fills in what follows from a solution: status, θ, intervals, verdicts, what is not seen.
/// @param free  parameters that were found
void describe(const AutocovarianceProblem& problem, const FilterModel& model,
              const AutocovarianceOptions& options, const LeastSquares& solution,
              const std::vector<int>& free, AutocovarianceFit& fit);

}  // namespace quadtune::internal
