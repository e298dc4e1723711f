// SPDX-License-Identifier: Apache-2.0
/// Filter models with logs for the benchmark of likelihoods.
#pragma once

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::bench {

struct KalmanProblem {
  FilterModel model;  ///< its start values are the true ones
  FilterRecord record;
};

/// The built-in altitude model at 5 ms with a known start: 2 states, 1 output, 2 parameters.
[[nodiscard]] KalmanProblem altitude_problem(int samples);

/// 12 states, 6 outputs that each measure one of them, all entries of A and G random, no inputs, at
/// 5 ms; or, if `sparse`, four chains of three integrators each.
/// @param parameters  4 … 18 variances: first those of the six outputs, then those of up to 12
///                    noises; the others are fixed.
[[nodiscard]] KalmanProblem large_problem(int samples, int parameters, bool sparse);

/// A linear model of the size of the extended filter of the uquad: 15 states, 16 outputs, 11
/// variances, all entries of A and G random, at 5 ms.
[[nodiscard]] KalmanProblem problem_of_extended_size(int samples);

/// The built-in extended filter of the uquad over a hover at 200 Hz in which every sensor measures
/// the constant true value plus noise.
[[nodiscard]] KalmanProblem uquad_hover(int samples);

}  // namespace quadtune::bench
