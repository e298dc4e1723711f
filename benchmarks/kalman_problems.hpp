// SPDX-License-Identifier: Apache-2.0
/// Filter models with their logs for the benchmark of likelihoods.
#pragma once

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::bench {

struct KalmanProblem {
  FilterModel model;  ///< its starts are the truth
  FilterRecord record;
};

/// The built-in altitude model at 5 ms, its start known: 2 states, 1 output, 2 parameters.
[[nodiscard]] KalmanProblem altitude_problem(int samples);

/// 12 states, 6 outputs that each see one, all entries of A and G drawn, no inputs, at 5 ms; or,
/// where `sparse`, four chains of three integrators each.
/// @param parameters  4 … 18 variances: of the six outputs first, then of up to 12 noises; those
///                    that are not counted are fixed.
[[nodiscard]] KalmanProblem large_problem(int samples, int parameters, bool sparse);

}  // namespace quadtune::bench
