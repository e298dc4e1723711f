// SPDX-License-Identifier: Apache-2.0
/// The same control law in another flight program's axes, order and sign law.
#pragma once

#include "quadtune/convention.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// Maps states by what they mean, so that the law commands the same motors in the same flight.
///
/// @param gains   states and integrals are any of its convention's, each once
/// @param target  states and integrals come out in the target's order
/// @return        K, K_int, x0 and u0 with signs and order of the target; a wrench is turned too
/// @throws InvalidInput  for a state that the gain's convention does not have, or wrong shapes.
[[nodiscard]] Gains in_convention(const Gains& gains, const Convention& target,
                                  SignLaw sign_law = SignLaw::set_point_minus_state);

/// The memory of a law whose inputs become u_to = W u_from.
/// @param W  (nu × nu) a permutation, with signs
[[nodiscard]] CommandMemory in_inputs(const CommandMemory& memory, const Eigen::MatrixXd& W);

}  // namespace quadtune
