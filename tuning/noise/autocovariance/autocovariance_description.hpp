// SPDX-License-Identifier: Apache-2.0
/// Estimates of the parameters from autocovariances, with their uncertainty.
#pragma once

#include <vector>

#include "noise/autocovariance/autocovariance_search.hpp"
#include "quadtune/tuning/autocovariance_fit.hpp"

namespace quadtune::internal {

/// Computes the results that follow from a solution: status, θ, intervals, verdicts, undetermined
/// directions.
/// @param free  indices of the estimated parameters
void describe(const AutocovarianceProblem& problem, const FilterModel& model,
              const AutocovarianceOptions& options, const LeastSquares& solution,
              const std::vector<int>& free, AutocovarianceFit& fit);

}  // namespace quadtune::internal
