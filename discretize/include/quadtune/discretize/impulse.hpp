// SPDX-License-Identifier: Apache-2.0
/// Impulse invariance: the discrete impulse response is the sampled continuous one.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// The response to a unit sample at k = 0 is dt times the plant's impulse response C e^(At) B,
/// sampled at t = k dt, with the value C B just after the impulse at k = 0. The factor dt makes the
/// area of the sample equal to that of the impulse, so that the low-frequency gains agree.
///
/// The state of the realization is the state just after the input, x[k] + B dt u[k]:
///   A_d = e^(A dt), B_d = A_d B dt, C_d = C, D_d = C B dt.
///
/// @param plant  A (nx × nx), B (nx × nu), D zero or empty; time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       The sampled plant. Names of states, inputs and outputs are kept; if C was empty,
///               the outputs are named after the states.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, D is not
///                       zero, or dt is so long that an entry of the result exceeds the range of a
///                       double.
/// Source: Oppenheim and Schafer 2009, section 7.2.1.
[[nodiscard]] DiscreteLti discretize_impulse(const ContinuousLti& plant, double dt);

}  // namespace quadtune
