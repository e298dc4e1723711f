// SPDX-License-Identifier: Apache-2.0
/// Stability of a loop with a delay.
#pragma once

#include <vector>

#include "quadtune/transfer_function.hpp"

namespace quadtune::internal {

/// Returns whether all roots of F(s) = den(s) + num(s) e^(-s delay) are in the open left
/// half-plane.
///
/// Computes the change of arg F(jω) from ω = 0 to infinity (Mikhailov's criterion) in closed form.
/// Where |L| < 1, F = den (1 + L), and arg(1 + L) stays within ±π/2; where |L| > 1,
/// F = num e^(-jω delay) (1 + 1/L), and arg(1 + 1/L) does. The arguments of den and num follow from
/// their roots. The delay therefore does not influence the cost. A loop with |L| ≥ 1 at infinity
/// has infinitely many roots in the right half-plane or on its border, and is unstable.
/// @param loop  proper, den of at least first degree
/// @param grid  increasing frequencies > 0 that resolve |L|, apart from lightly damped zeros of
///              num, which are added [rad/s]
/// @param sizes |L| on the grid
[[nodiscard]] bool stable_with_delay(const ContinuousTransferFunction& loop,
                                     const std::vector<double>& grid,
                                     const std::vector<double>& sizes);

}  // namespace quadtune::internal
