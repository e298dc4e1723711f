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

/// A linear model of the size of the uquad's extended filter: 15 states, 16 outputs, 11 variances,
/// all entries of A and G drawn, at 5 ms.
[[nodiscard]] KalmanProblem problem_of_extended_size(int samples);

/// The built-in uquad's extended filter over a hover at 200 Hz of which every sensor says all the
/// time what is so, but for its noise.
[[nodiscard]] KalmanProblem uquad_hover(int samples);

}  // namespace quadtune::bench
