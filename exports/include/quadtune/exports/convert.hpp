// SPDX-License-Identifier: Apache-2.0
/// Converts a control law to the axes, order and sign law of another flight program.
#pragma once

#include "quadtune/convention.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// Maps states by their meaning, so that the law commands the same motors in the same flight.
///
/// @param gains   states and integrals: any of its convention, each at most once
/// @param target  convention of the result, with states and integrals in its order
/// @param sign_law  sign law of the result
/// @return        K, K_int, x0 and u0 in the order and signs of the target; a wrench is rotated too
/// @throws InvalidInput  if a state is not in the convention of `gains`, or shapes disagree
[[nodiscard]] Gains in_convention(const Gains& gains, const Convention& target,
                                  SignLaw sign_law = SignLaw::set_point_minus_state);

/// Transforms the memory of a law to inputs u_to = W u_from.
/// @param memory  of past commands and motor lags, in the inputs u_from
/// @param W       (nu × nu) a permutation, with signs
[[nodiscard]] CommandMemory in_inputs(const CommandMemory& memory, const Eigen::MatrixXd& W);

}  // namespace quadtune
