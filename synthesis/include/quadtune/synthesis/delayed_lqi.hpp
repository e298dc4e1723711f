// SPDX-License-Identifier: Apache-2.0
/// Linear-quadratic regulators with integrals of outputs and with inputs that act whole samples
/// late, for plants that are given as matrices.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {

/// A plant with the integrals of its outputs and its earlier commands as further states, and the
/// cost of these states.
template <class Lti>
struct AugmentedLqr {
  Lti plant;           ///< states [x | ∫y | u[k-1] … u[k-delay]], no outputs
  LqrWeights weights;  ///< of this plant
};

/// Appends i' = C x + D u to the plant. With them, u = -K x + K_int ∫(r - y) follows constant r
/// without error; K_int = K_i, where [K K_i] is the gain of the augmented problem.
/// @param plant    nx states; its ny outputs are integrated
/// @param weights  Q ((nx + ny) × (nx + ny)), R, N ((nx + ny) × nu, or empty for zero)
/// @throws InvalidInput  as validate(), or for wrong shapes of Q and N
[[nodiscard]] AugmentedLqr<ContinuousLti> with_output_integrals(const ContinuousLti& plant,
                                                                const LqrWeights& weights);
/// The same with i[k+1] = i[k] + dt (C x[k] + D u[k]), as a program integrates.
[[nodiscard]] AugmentedLqr<DiscreteLti> with_output_integrals(const DiscreteLti& plant,
                                                              const LqrWeights& weights);

/// Delays the input: the plant is driven by u[k-delay], so that the law is
/// u = -K x - Σ K_past,j u[k-j]. The minimum of the cost is reached by predicting the state:
/// K_x = K A^delay and K_past,j = K A^(j-1) B with the gain K of the plant without delay.
/// @param problem  discrete, without a delay
/// @param delay    [samples], 0 ≤ delay ≤ 2000
/// @return         if N is not empty, the cost of a command is counted when the command acts: its R
///                 is part of Q, and R of the result is 0
/// @throws InvalidInput  as validate(); if the delay is out of range; with a delay also for wrong
///                       shapes of Q, R and N
[[nodiscard]] AugmentedLqr<DiscreteLti> with_input_delay(const AugmentedLqr<DiscreteLti>& problem,
                                                         int delay);

}  // namespace quadtune
